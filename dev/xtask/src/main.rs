//! Chores of the repository: `cargo xtask <chore>`.

mod driver;
mod edges;

use std::path::{Path, PathBuf};
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

/// A picture of the README.
struct Shot {
    name: &'static str,
    /// A file, or a procedural scene with its options.
    scene: &'static str,
    /// Options of the bake, and of the picture.
    bake: &'static str,
    render: &'static str,
}

const fn shot(name: &'static str, scene: &'static str, bake: &'static str, render: &'static str) -> Shot {
    Shot { name, scene, bake, render }
}

const LAMPS: &str = "city --scale 0.25 --lamps 165";
/// Towers, far away.
const FAR: &str = "--size 480x270 --eye 700,220,600 --target 60,40,0 --fov 14 --device gpu";

const FAR_MAPS: &str = "--size 480x270 --eye 700,220,600 --target 60,40,0 --fov 14 --device gpu --technique csm";

/// Those with `--device gpu` are drawn on the graphics card, the others with gathered light.
const PICTURES: [Shot; 17] = [
    shot("city", "city", "", "--size 960x540 --camera overview --filter 3"),
    shot("city-rooftops", "city", "", "--size 480x270 --camera rooftops --filter 3"),
    shot("landscape", "landscape", "", "--size 480x270 --camera overview --filter 3"),
    shot("delft", "../shared/scenes/delft.glb", "", "--size 480x270 --filter 3"),
    shot("colosseum", "../shared/scenes/colosseum.glb", "", "--size 480x270 --filter 3"),
    shot("kaykit-city", "../shared/scenes/kaykit-city.glb", "", "--size 480x270 --day --filter 3"),
    shot(
        "kaykit-city-night",
        "../shared/scenes/kaykit-city.glb",
        "",
        "--size 480x270 --night --filter 5 --kernel tent",
    ),
    shot("village", "village", "", "--size 960x540 --camera overview --filter 5 --kernel tent"),
    shot("village-street", "village", "", "--size 480x270 --camera street --filter 5 --kernel tent"),
    shot("ruins", "ruins", "", "--size 480x270 --camera nave --filter 3"),
    shot("grove", "../shared/scenes/grove.glb", "", "--size 480x270 --eye=7,5,10 --target=-9,6,-9 --fov 60 --filter 3"),
    shot(
        "lamps",
        LAMPS,
        "--resolution 4096",
        "--size 960x540 --night --camera overview --filter 9 --kernel tent --device gpu",
    ),
    shot("shafts", "city", "--sun 5,16", "--size 960x540 --camera skyline --fog 0.0015 --device gpu"),
    shot("shafts-street", "city", "--sun 5,16", "--size 480x270 --camera street --fog 0.004 --device gpu"),
    shot(
        "market",
        "market",
        "--resolution 4096",
        "--size 960x540 --device gpu --lamp-maps cube --filter 3 --fog 0.01 --vpls 128 --samples 3",
    ),
    shot("far-csm", "city", "", FAR_MAPS),
    shot("far-dag", "city", "", FAR),
];

fn pictures() -> Result<()> {
    let scratch = Path::new("target").join("pictures");
    std::fs::create_dir_all(&scratch).context("cannot make target/pictures")?;
    for Shot { name, scene, bake, render } in PICTURES {
        let words = |text: &'static str| text.split_whitespace();
        let file = if scene.ends_with(".glb") {
            PathBuf::from(scene)
        } else {
            let file = scratch.join(format!("{}.glb", scene.replace([' ', '.'], "-")));
            let out = file.display().to_string();
            antumbra(&[&["scene"], &words(scene).collect::<Vec<_>>()[..], &["-o", &out]].concat())?;
            file
        };
        if !file.exists() {
            println!("{scene} is not there: {name}.png stays as it is");
            continue;
        }
        let file = file.display().to_string();
        let shadows = scratch.join(format!("{name}.antumbra")).display().to_string();
        antumbra(&[&["bake", &file, "-o", &shadows], &words(bake).collect::<Vec<_>>()[..]].concat())?;
        let picture = format!("docs/figures/{name}.png");
        let draw = ["render", &file, "--shadows", &shadows, "-o", &picture];
        antumbra(&[&draw, &words(render).collect::<Vec<_>>()[..]].concat())?;
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
