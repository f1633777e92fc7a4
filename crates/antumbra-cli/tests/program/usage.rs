//! Help, exit codes, what is wrong with arguments, and what comes later.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use crate::folder::{antumbra, arguments, command, folder, run};

const COMMANDS: [&str; 11] =
    ["demo", "scene", "bake", "info", "validate", "query", "compare", "render", "view", "rebuild", "bench"];

#[test]
fn every_command_has_help_with_an_example() {
    let all = antumbra(["--help"]).ok();
    for name in COMMANDS {
        assert!(all.contains(&format!("\n  {name} ")), "{name} is not listed");
        let help = antumbra([name, "--help"]).ok();
        let example = help.rsplit("Example:\n").next().expect("text");
        assert!(
            example.starts_with(&format!("  antumbra {name} ")) && example.trim_end().lines().count() == 1,
            "{help}"
        );
    }
    let scenes = antumbra(["scene", "--help"]).ok();
    assert!(scenes.contains("  city  ") && scenes.contains("  landscape  "), "{scenes}");
}

#[test]
fn bad_usage_is_told_apart() {
    antumbra([""; 0]).misused("Usage");
    let bad = [
        ("frobnicate", "frobnicate"),
        ("bake", "--output"),
        ("bake a.glb -o b --resolution 1000", "power of two"),
        ("bake a.glb -o b --resolution 32", "power of two"),
        ("bake a.glb -o b --resolution 64 --texel-size 1", "cannot be used with"),
        ("bake a.glb -o b --texel-size 0", "more than 0"),
        ("bake a.glb -o b --sun 1", "2 finite numbers"),
        ("bake a.glb -o b --sun 0,100", "elevation"),
        ("bake a.glb -o b --bounds 0,0,0,1,1,-1", "first corner"),
        ("bake a.glb -o b --interior thickness=-1", "more than 0"),
        ("bake a.glb -o b --interior solid", "auto, open, closed"),
        ("bake a.glb -o b --memory-limit lots", "number of bytes"),
        ("bake a.glb -o b --threads 0", "--threads"),
        ("bake a.glb -o b --method magic", "magic"),
        ("bench construction --methods magic", "kampe2015-without-culling"),
        ("bench construction --largest 1000", "power of two"),
        ("bench construction --threads-list 0", "--threads-list"),
        ("bench lamps a.glb --lamps 5", "cannot be used with"),
        ("query f --light sun --points p -o v --filter 4", "odd"),
        ("query f --light sun --points p -o v --filter 19", "odd"),
        ("scene atlantis -o a.glb", "city"),
        ("scene city -o a.glb --scale 9", "0.05"),
        ("scene city -o a.glb --lamps 4001", "4000"),
        ("scene landscape -o a.glb --lamps 5", "takes no lamps"),
        ("render a.glb -o a.png --size 10", "1280x720"),
        ("render a.glb -o a.png --eye 0,0,0", "--target"),
        ("compare f a.glb --samples 0", "samples"),
    ];
    for (line, word) in bad {
        run(Path::new("."), line).misused(word);
    }
}

#[test]
fn what_comes_later_says_so() {
    let folder = folder();
    let later = [
        "rebuild f a.glb b.glb -o g",
        "bench everything",
        "bake {city} -o {b} --resume",
        "bake {city} -o {b} --encoding best",
    ];
    for line in later {
        run(folder.path(), line).fails(&["not in this version"]);
    }
    // What failed left nothing behind.
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[test]
fn missing_files_and_folders_are_named() {
    let folder = folder();
    for line in ["info {x}", "validate {x}", "bake {x.glb} -o {b}", "render {x.glb} -o {p}", "compare {x} {city}"] {
        run(folder.path(), line).fails(&["cannot read", "x"]);
    }
    run(folder.path(), "bake {city} -o {no/b}").fails(&["there is no folder", "no"]);
    run(folder.path(), "scene city -o .").fails(&["it is a folder"]);
    run(folder.path(), "query {baked} --light moon --points {p} -o {v}").fails(&["no light \"moon\"", "sun"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_or_full_stdout_is_no_panic() {
    let folder = folder();
    for line in ["info {baked}", "info {baked} --json", "bake --help", "validate {baked}"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
        let done = command(arguments(folder.path(), line)).stdout(full).output().expect("the program runs");
        assert!(!String::from_utf8_lossy(&done.stderr).contains("panicked"), "{line}");
        // A pipe whose reader is gone before the program has begun.
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let done = command(arguments(folder.path(), line)).stdout(writer).stderr(Stdio::piped()).output();
        let done = done.expect("the program runs");
        assert_eq!((done.status.code(), &done.stderr[..]), (Some(0), &b""[..]), "{line}");
    }
}
