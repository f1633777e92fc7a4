//! Bakes as child processes of this same program, so that memory and processor time by the system's own accounting are one bake's
//! alone.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};

use antumbra_scene::{Scene, to_glb};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use tempfile::TempDir;

/// Where children work: a folder that is gone in the end, whatever happens.
pub struct Workshop {
    folder: TempDir,
    program: PathBuf,
}

/// What became of a bake.
pub enum Outcome {
    /// What `antumbra bake --json` printed.
    Baked(Value),
    /// It needed more memory than it may take, or than there is; the child's words.
    OutOfMemory(String),
}

impl Workshop {
    /// In the system's folder for temporary files.
    pub fn new() -> Result<Self> {
        let folder = tempfile::Builder::new().prefix("antumbra-bench-").tempdir();
        let folder =
            folder.context("cannot make a folder for temporary files; set TMPDIR to one that can be written")?;
        let program =
            std::env::current_exe().context("cannot find this program's own file, which is to run the bakes")?;
        Ok(Self { folder, program })
    }

    /// Writes a scene for children to read.
    pub fn write(&self, name: &str, scene: &Scene) -> Result<PathBuf> {
        let path = self.folder.path().join(format!("{name}.glb"));
        fs::write(&path, to_glb(scene)?).with_context(|| format!("cannot write {}", path.display()))?;
        Ok(path)
    }

    /// Bakes the papers' graph of a scene, with further arguments of `antumbra bake`.
    pub fn bake(&self, scene: &Path, arguments: &[String]) -> Result<Outcome> {
        let child = Command::new(&self.program)
            .arg("bake")
            .arg(scene)
            .arg("-o")
            .arg(self.folder.path().join("bake.antumbra"))
            .args(["--encoding", "dag8", "--json", "--quiet"])
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .with_context(|| format!("cannot run {}", self.program.display()))?;
        outcome(&child)
    }
}

fn outcome(child: &Output) -> Result<Outcome> {
    if child.status.success() {
        let json = serde_json::from_slice(&child.stdout).context("a child's bake printed no JSON")?;
        return Ok(Outcome::Baked(json));
    }
    let stderr = String::from_utf8_lossy(&child.stderr);
    let last = stderr.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default();
    let words = last.strip_prefix("error: ").unwrap_or(last);
    if is_out_of_memory(words) || (words.is_empty() && was_killed(child.status)) {
        return Ok(Outcome::OutOfMemory(if words.is_empty() {
            "killed by the system".to_owned()
        } else {
            words.to_owned()
        }));
    }
    if words.is_empty() { bail!("a child's bake ended with {}", child.status) } else { bail!("{words}") }
}

/// Whether a bake's last words are of its memory limit, or of an allocation that failed.
fn is_out_of_memory(words: &str) -> bool {
    ["that it may take", "the scene alone takes", "memory allocation of"].iter().any(|sign| words.contains(sign))
}

/// Systems kill processes thus when memory runs out.
#[cfg(unix)]
fn was_killed(status: ExitStatus) -> bool {
    const SIGKILL: i32 = 9;
    std::os::unix::process::ExitStatusExt::signal(&status) == Some(SIGKILL)
}

#[cfg(not(unix))]
fn was_killed(_: ExitStatus) -> bool {
    false
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::process::ExitStatusExt;

    use super::*;

    fn child(wait_status: i32, stdout: &str, stderr: &str) -> Result<Outcome> {
        let status = ExitStatus::from_raw(wait_status);
        outcome(&Output { status, stdout: stdout.into(), stderr: stderr.into() })
    }

    #[test]
    fn children_end_in_different_ways() {
        assert!(matches!(child(0, "{\"file_bytes\": 5}", ""), Ok(Outcome::Baked(json)) if json["file_bytes"] == 5));
        assert!(child(0, "", "").is_err());
        let failed = child(1 << 8, "", "warning: x\nerror: cannot read a.glb\n").err().expect("an error");
        assert_eq!(failed.to_string(), "cannot read a.glb");
        let limit =
            "error: cannot bake: the bake needs more than the 5 MiB that it may take, at building; allow more\n";
        assert!(
            matches!(child(1 << 8, "", limit), Ok(Outcome::OutOfMemory(words)) if words.starts_with("cannot bake"))
        );
        assert!(matches!(child(9, "", ""), Ok(Outcome::OutOfMemory(_))));
        assert!(child(11, "", "").is_err());
    }
}
