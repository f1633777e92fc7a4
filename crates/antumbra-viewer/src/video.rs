//! Pictures and folders of frames that an area light shows.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use antumbra_render::area::Emission;

/// Most frames of a video: a minute of 60 each second.
const MOST_FRAMES: usize = 3600;

/// The frames of a folder of pictures, by name, or a picture as a single frame.
pub(crate) fn frames(path: &Path) -> Result<Vec<Arc<Emission>>, String> {
    let frames: Vec<_> = files(path)?.iter().map(|file| frame(file)).collect::<Result<_, _>>()?;
    if frames.is_empty() { Err(format!("{} holds no files", path.display())) } else { Ok(frames) }
}

fn files(path: &Path) -> Result<Vec<PathBuf>, String> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let read = || -> std::io::Result<Vec<PathBuf>> {
        std::fs::read_dir(path)?.map(|entry| entry.map(|entry| entry.path())).collect()
    };
    let mut files = read().map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    files.retain(|file| file.is_file());
    files.sort();
    if files.len() > MOST_FRAMES {
        return Err(format!(
            "{} holds {} files; a video has at most {MOST_FRAMES} frames",
            path.display(),
            files.len()
        ));
    }
    Ok(files)
}

fn frame(path: &Path) -> Result<Arc<Emission>, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    let image = antumbra_scene::decode_image(&path.display().to_string(), &bytes).map_err(|error| error.to_string())?;
    Emission::of_image(&image).map(Arc::new).ok_or_else(|| format!("{} is empty", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_videos() {
        let folder = std::env::temp_dir().join(format!("antumbra-frames-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let empty = frames(&folder).expect_err("no frames");
        assert!(empty.contains("holds no files"), "{empty}");
        std::fs::write(folder.join("a.png"), b"no picture").expect("a file");
        let wrong = frames(&folder).expect_err("no picture");
        assert!(wrong.contains("a.png"), "{wrong}");
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
