//! Chores of the repository: `cargo xtask <chore>`.

mod driver;
mod edges;

use std::path::Path;
use std::process::{Command, ExitCode};

use anyhow::{Context, Result, bail};

const USAGE: &str = "usage: cargo xtask <chore>

chores:
  test      everything that must hold: formatting, lints, crate edges, the no_std build, docs, all tests; installs a
            software Vulkan driver where there is none
  edges     check which crates depend on which
  bless     write the golden files anew, after a change of the bytes that is meant
  pictures  render the README's pictures into docs/figures (scenes from ../shared/scenes where they are)
";

fn main() -> ExitCode {
    let chore = std::env::args().nth(1);
    let done = match chore.as_deref() {
        Some("test") => test(),
        Some("edges") => edges::check(),
        Some("bless") => bless(),
        Some("pictures") => pictures(),
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn test() -> Result<()> {
    driver::ensure()?;
    cargo("fmt", &["--all", "--check"])?;
    edges::check()?;
    cargo("clippy", &["--workspace", "--all-targets", "--", "-D", "warnings"])?;
    cargo("build", &["-p", "antumbra", "--no-default-features"])?;
    run(Command::new("cargo").args(["doc", "--workspace", "--no-deps", "--quiet"]).env("RUSTDOCFLAGS", "-D warnings"))?;
    cargo("test", &["--workspace"])
}

fn bless() -> Result<()> {
    let golden = ["test", "-p", "antumbra-bake", "--test", "format", "golden_bytes"];
    run(Command::new("cargo").args(golden).env("ANTUMBRA_BLESS", "1"))
}

/// From under the trees.
const GROVE: &[&str] = &["--eye=7,5,10", "--target=-9,6,-9", "--fov", "60", "--filter", "3"];

/// Name, scene, size, and further words for `antumbra render`; the shadows are baked first.
const PICTURES: [(&str, &str, &str, &[&str]); 11] = [
    ("city", "city", "960x540", &["--camera", "overview", "--filter", "3"]),
    ("city-rooftops", "city", "480x270", &["--camera", "rooftops", "--filter", "3"]),
    ("landscape", "landscape", "480x270", &["--camera", "overview", "--filter", "3"]),
    ("delft", "../shared/scenes/delft.glb", "480x270", &["--filter", "3"]),
    ("colosseum", "../shared/scenes/colosseum.glb", "480x270", &["--filter", "3"]),
    ("kaykit-city", "../shared/scenes/kaykit-city.glb", "480x270", &["--day", "--filter", "3"]),
    (
        "kaykit-city-night",
        "../shared/scenes/kaykit-city.glb",
        "480x270",
        &["--night", "--filter", "5", "--kernel", "tent"],
    ),
    ("village", "village", "960x540", &["--camera", "overview", "--filter", "5", "--kernel", "tent"]),
    ("village-street", "village", "480x270", &["--camera", "street", "--filter", "5", "--kernel", "tent"]),
    ("ruins", "ruins", "480x270", &["--camera", "nave", "--filter", "3"]),
    ("grove", "../shared/scenes/grove.glb", "480x270", GROVE),
];

fn pictures() -> Result<()> {
    let scratch = Path::new("target").join("pictures");
    std::fs::create_dir_all(&scratch).context("cannot make target/pictures")?;
    for (name, scene, size, words) in PICTURES {
        let mut file = scene.to_owned();
        if !scene.ends_with(".glb") {
            file = scratch.join(format!("{scene}.glb")).display().to_string();
            antumbra(&["scene", scene, "-o", &file])?;
        } else if !Path::new(scene).exists() {
            println!("{scene} is not there: {name}.png stays as it is");
            continue;
        }
        let shadows = scratch.join(format!("{name}.antumbra")).display().to_string();
        antumbra(&["bake", &file, "-o", &shadows])?;
        let picture = format!("docs/figures/{name}.png");
        let render = ["render", &file, "--shadows", &shadows, "--size", size, "-o", &picture];
        antumbra(&[&render, words].concat())?;
    }
    Ok(())
}

fn antumbra(words: &[&str]) -> Result<()> {
    let run_program = ["--release", "--quiet", "--package", "antumbra-cli", "--"];
    cargo("run", &[&run_program, words].concat())
}

fn cargo(chore: &str, words: &[&str]) -> Result<()> {
    run(Command::new("cargo").arg(chore).args(words))
}

fn run(command: &mut Command) -> Result<()> {
    println!("$ {}", format!("{command:?}").replace('"', ""));
    let status = command.status().context("cannot start cargo")?;
    if status.success() { Ok(()) } else { bail!("failed: {command:?}") }
}
