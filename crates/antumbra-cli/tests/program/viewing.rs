//! view: the window, on a display of its own where Xvfb is installed.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::folder::{arguments, command, folder, run};

/// A display that nobody sees.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// `None` where Xvfb is not installed.
    fn open() -> Option<Self> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "800x600x24"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let mut number = String::new();
        BufReader::new(server.stdout.take()?).read_line(&mut number).ok()?;
        Some(Self { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

const SCRIPT: &str = "wait-bake
set filter 5
frame -60,60,-60 0,0,0
screenshot PATH/first.png
set sun 90,30
frame -60,60,-60 0,0,0
wait-bake
frame -60,60,-60 0,0,0
screenshot PATH/second.png
set technique maps
frame -60,60,-60 0,0,0
screenshot PATH/maps.png
set fog 0.01
set area on
set vpls 4
set voxels 32
set light 0,60,0
set shape sphere
set size 20,20
set color 1,0.1,0.1
frame -60,60,-60 0,0,0
screenshot PATH/area.png
";

#[test]
fn a_script_is_replayed_in_the_window() {
    let Some(display) = Display::open() else {
        println!("Xvfb is not installed: the window was not tested");
        return;
    };
    let folder = folder();
    let script = SCRIPT.replace("PATH", &folder.path().display().to_string());
    fs::write(folder.path().join("way.txt"), script).expect("a file");
    let line = "view {city} --script {way.txt} --size 480x300 --resolution 1024";
    let mut view = command(arguments(folder.path(), line));
    let done = view.env("DISPLAY", &display.name).env_remove("WAYLAND_DISPLAY").output().expect("the program runs");
    let (out, errors) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{errors}");
    assert!(out.contains(" frames, "), "{out}");
    let picture = |name: &str| image::open(folder.path().join(name)).expect("a screenshot").to_rgb8();
    let shots = ["first.png", "second.png", "maps.png", "area.png"].map(picture);
    for shot in &shots {
        assert_eq!((shot.width(), shot.height()), (480, 300));
        let corner = shot.get_pixel(479, 0);
        assert!(shot.pixels().filter(|pixel| *pixel != corner).count() > 10_000, "an empty picture");
    }
    // The sun went elsewhere, and maps show much the same as a bake.
    let unlike = |a: &image::RgbImage, b: &image::RgbImage| {
        let far = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 24);
        // Right of the panel.
        let beside = |image: &image::RgbImage| -> Vec<image::Rgb<u8>> {
            image.enumerate_pixels().filter(|(x, ..)| *x > 320).map(|(.., pixel)| *pixel).collect()
        };
        let (a, b) = (beside(a), beside(b));
        a.iter().zip(&b).filter(|pair| far(*pair)).count() as f64 / a.len() as f64
    };
    let (moved, mapped) = (unlike(&shots[0], &shots[1]), unlike(&shots[1], &shots[2]));
    assert!(moved > 0.02 && mapped < 0.1 && mapped < moved, "{moved} {mapped}");
    // A red lantern makes it night.
    let red = shots[3].pixels().filter(|pixel| pixel.0[0] > pixel.0[2].saturating_add(60)).count();
    assert!(red > 2_000, "{red} red pixels");
}

#[test]
fn a_window_that_cannot_be_says_so() {
    let folder = folder();
    fs::write(folder.path().join("wrong.txt"), "wait-bake\nfly away\n").expect("a file");
    run(folder.path(), "view {city} --script {wrong.txt}").fails(&["line 2 of the script", "fly away", "wait-bake"]);
    run(Path::new("."), "view no.glb").fails(&["cannot read", "no.glb"]);
    if cfg!(target_os = "linux") {
        let mut view = command(arguments(folder.path(), "view {city}"));
        let done = view.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").output();
        let done = done.expect("the program runs");
        let words = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(1), "{words}");
        assert!(words.contains("there is no display") && words.contains("antumbra render"), "{words}");
    }
}
