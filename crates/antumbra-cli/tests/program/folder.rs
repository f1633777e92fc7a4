//! A small city and its bake, made once, and a folder of its own for each test.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use serde_json::Value;

/// What the program did.
pub struct Done {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Done {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code().expect("the program was killed"),
            stdout: String::from_utf8(output.stdout).expect("stdout is text"),
            stderr: String::from_utf8(output.stderr).expect("stderr is text"),
        }
    }
}

impl Done {
    /// Stdout, after a run that worked.
    #[track_caller]
    pub fn ok(self) -> String {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self.stdout
    }

    /// Stdout as JSON, after a run that worked.
    #[track_caller]
    pub fn json(self) -> Value {
        serde_json::from_str(&self.ok()).expect("JSON alone on stdout")
    }

    /// The one sentence of a run that failed, which holds all of `words`.
    #[track_caller]
    pub fn fails(self, words: &[&str]) {
        assert_eq!((self.code, self.stdout.as_str()), (1, ""), "{}", self.stderr);
        let lines: Vec<&str> = self.stderr.lines().filter(|line| !line.starts_with("warning: ")).collect();
        let [sentence] = lines[..] else { panic!("not one sentence:\n{}", self.stderr) };
        assert!(sentence.starts_with("error: "), "{sentence}");
        for word in words {
            assert!(sentence.contains(word), "no `{word}` in: {sentence}");
        }
    }

    /// A run that was asked for in the wrong way.
    #[track_caller]
    pub fn misused(self, word: &str) {
        assert_eq!((self.code, self.stdout.as_str()), (2, ""), "{}", self.stderr);
        assert!(self.stderr.contains(word), "no `{word}` in: {}", self.stderr);
    }
}

/// Runs the program.
pub fn antumbra<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Done {
    command(arguments).output().expect("the program runs").into()
}

/// The program, not yet running.
pub fn command<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_antumbra"));
    command.args(arguments);
    command
}

/// Runs the program with the words of a line; `{name}` stands for a path in the folder, and `{city}` and `{baked}` for
/// the small city and its bake.
pub fn run(folder: &Path, line: &str) -> Done {
    antumbra(arguments(folder, line))
}

/// The words of a line, with their names filled in.
pub fn arguments(folder: &Path, line: &str) -> Vec<PathBuf> {
    let fill = |word: &str| match word.strip_prefix('{').and_then(|word| word.strip_suffix('}')) {
        Some("city") => CITY.0.clone(),
        Some("baked") => CITY.1.clone(),
        Some(name) => folder.join(name),
        None => PathBuf::from(word),
    };
    line.split_whitespace().map(fill).collect()
}

/// A GLB with its JSON changed.
pub fn edit_glb(glb: &[u8], edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    let mut root: Value = serde_json::from_slice(&glb[20..20 + length]).expect("glTF");
    edit(&mut root);
    let mut json = root.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let rest = &glb[20 + length..];
    let total = (20 + json.len() + rest.len()) as u32;
    let chunk = (json.len() as u32).to_le_bytes();
    [&glb[..8], &total.to_le_bytes(), &chunk, b"JSON", &json, rest].concat()
}

/// A folder that is gone after the test.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder")
}

/// A small city, and its sun baked at 1024.
static CITY: LazyLock<(PathBuf, PathBuf)> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("city");
    fs::create_dir_all(&folder).expect("a folder");
    let (city, baked) = (folder.join("city.glb"), folder.join("city.antumbra"));
    antumbra(["scene", "city", "--scale", "0.15", "-o"].map(OsStr::new).into_iter().chain([city.as_os_str()])).ok();
    let [bake, o, resolution, n] = ["bake", "-o", "--resolution", "1024"].map(OsStr::new);
    antumbra([bake, city.as_os_str(), o, baked.as_os_str(), resolution, n]).ok();
    (city, baked)
});
