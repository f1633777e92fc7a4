//! render and demo.

use std::fs;
use std::path::Path;

use crate::folder::{folder, run};

fn size_of_png(path: &Path) -> (u32, u32) {
    image::image_dimensions(path).expect("a picture")
}

#[test]
fn pictures_come_from_bakes_and_rays() {
    let folder = folder();
    let picture = folder.path().join("p.png");
    let mut seen = Vec::new();
    for options in ["", "--shadows {baked}", "--shadows {baked} --technique traced", "--shadows {baked} --filter 9"] {
        let line = format!("render {{city}} -o {{p.png}} --size 48x32 --samples 1 {options}");
        let text = run(folder.path(), &line).ok();
        assert!(text.contains("48 x 32"), "{text}");
        assert_eq!(size_of_png(&picture), (48, 32));
        seen.push(fs::read(&picture).expect("a file"));
    }
    assert!(seen[0] == seen[2], "a bake of the scene's own sun changed a traced picture");
    assert!(seen[1] != seen[3], "the filter changed nothing");
}

#[test]
fn the_picture_is_lit_as_the_bake_was() {
    let folder = folder();
    run(folder.path(), "bake {city} -o {east} --sun 90,20 --resolution 1024").ok();
    let line = "render {city} -o {p.png} --size 32x32 --samples 1 --technique traced";
    run(folder.path(), line).ok();
    let own = fs::read(folder.path().join("p.png")).expect("a file");
    run(folder.path(), &format!("{line} --shadows {{east}}")).ok();
    assert!(own != fs::read(folder.path().join("p.png")).expect("a file"));
}

#[test]
fn cameras_are_chosen_by_name_or_place() {
    let folder = folder();
    let line = "render {city} -o {p.png} --size 16x16 --samples 1";
    run(folder.path(), &format!("{line} --camera keyhole")).fails(&["no camera \"keyhole\"", "it has: "]);
    run(folder.path(), &format!("{line} --eye -50,80,-50 --target 0,0,0 --fov 60")).ok();
    run(folder.path(), &format!("{line} --eye 1,1,1 --target 1,1,1")).fails(&["--eye"]);
    run(folder.path(), &format!("{line} --eye 1,1,1 --target 0,0,0 --fov 200")).fails(&["field of view"]);
    run(folder.path(), &format!("{line} --technique dag")).fails(&["--shadows"]);
    run(folder.path(), "render {city} -o {p.png} --size 100000x1").fails(&["16384"]);
}

#[test]
fn both_devices_draw_the_same_picture() {
    let folder = folder();
    run(folder.path(), "bake {city} -o {b} --levels --enter-depths --resolution 2048").ok();
    for way in [
        "--shadows {b} --filter 5",
        "--shadows {b} --continuous",
        "--shadows {b} --penumbra 2",
        "--technique csm --cascades 2",
        "--shadows {b} --fog 0.01",
    ] {
        let mut drawn = Vec::new();
        for device in ["cpu", "gpu"] {
            let line = format!("render {{city}} -o {{{device}.png}} --size 96x64 --samples 1 {way} --device {device}");
            run(folder.path(), &line).ok();
            drawn.push(image::open(folder.path().join(format!("{device}.png"))).expect("a picture").to_rgb8());
        }
        let off = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 1;
        let differ = drawn[0].as_raw().iter().zip(drawn[1].as_raw()).filter(|pair| off(*pair)).count();
        assert!(differ < drawn[0].as_raw().len() / 200, "{way}: {differ} bytes differ");
    }
    let gpu = "render {city} -o {p.png} --size 16x16 --device gpu";
    run(folder.path(), gpu).fails(&["traces no rays", "--shadows"]);
    run(folder.path(), &format!("{gpu} --shadows {{b}} --gather 4")).fails(&["--gather"]);
    run(folder.path(), &format!("{gpu} --shadows {{b}} --fog 0")).fails(&["density"]);
    run(folder.path(), &format!("{gpu} --shadows {{baked}} --penumbra 1")).fails(&["--enter-depths"]);
    run(folder.path(), &format!("{gpu} --shadows {{b}} --continuous --prefilter mean")).fails(&["hard"]);
    run(folder.path(), "render {city} -o {p.png} --size 16x16 --continuous").fails(&["--shadows FILE"]);
    run(folder.path(), &format!("{gpu} --shadows {{b}} --penumbra 50")).fails(&["30 degrees"]);
}

#[test]
fn area_lights_light_a_night_and_its_fog() {
    let folder = folder();
    let light = "--area-light disc=8 --light-at 0,90,0 --luminance 1000 --vpls 16 --voxels 32";
    let draw = |name: &str, more: &str| {
        let line = format!("render {{city}} -o {{{name}.png}} --size 96x64 --samples 1 --gather 0 {light} {more}");
        run(folder.path(), &line).ok();
        image::open(folder.path().join(format!("{name}.png"))).expect("a picture").to_rgb8()
    };
    let unlike = |a: &image::RgbImage, b: &image::RgbImage| {
        a.as_raw().iter().zip(b.as_raw()).filter(|(a, b)| a.abs_diff(**b) > 8).count() as f64 / a.as_raw().len() as f64
    };
    let (voxels, traced) = (draw("voxels", "--fog 0.01"), draw("traced", "--fog 0.01 --area-shadows traced"));
    let (none, average) =
        (draw("none", "--area-shadows none --fog 0.01"), draw("average", "--fog 0.01 --airlight average"));
    assert!(unlike(&voxels, &traced) < unlike(&none, &traced), "voxels are no better than no shadows");
    assert_ne!(voxels, average);
    let city = "render {city} -o {p.png} --size 16x16";
    run(folder.path(), &format!("{city} --area-light disc=8")).misused("--light-at");
    run(folder.path(), &format!("{city} --area-light cube=1 --light-at 0,0,0")).misused("rectangle=WIDTH,HEIGHT");
    run(folder.path(), &format!("{city} --area-light disc=1 --light-at 0,9,0 --voxels 100")).misused("multiple of 32");
    // The card draws them as the processor does, and traces none.
    let (on_cpu, on_gpu) = (
        draw("cpu", "--fog 0.01 --device cpu --area-memory 1"),
        draw("gpu", "--fog 0.01 --device gpu --area-gather full"),
    );
    let off = unlike(&on_cpu, &on_gpu);
    assert!(off < 0.02, "{off}");
    run(folder.path(), &format!("{city} {light} --device gpu --area-shadows traced")).fails(&["processor", "traces"]);
    // A scene's own lights are lit without being asked for.
    run(folder.path(), "scene screen --scale 0.1 -o {screen.glb} --quiet").ok();
    let screen = "render {screen.glb} --size 48x32 --samples 1 --vpls 8 --voxels 32 --gather 0 --fog 0.02 -o {s.png}";
    run(folder.path(), &format!("{screen} --device gpu")).ok();
    run(folder.path(), &format!("{screen} --video-time 3.6")).ok();
    run(folder.path(), &format!("{city} {light} --luminance=-1")).misused("cannot be used multiple times");
    run(folder.path(), &format!("{city} {light} --light-towards 0,90,0")).fails(&["shines nowhere"]);
    run(folder.path(), &format!("{city} {light} --light-image {{city}}")).fails(&[
        "city.glb",
        "PNG, JPEG and WebP",
        "another picture",
    ]);
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_driver_it_says_what_to_install() {
    use crate::folder::{Done, arguments, command};

    let folder = folder();
    let mut render = command(arguments(folder.path(), "render {city} --shadows {baked} --device gpu -o {p.png}"));
    let done: Done = render
        .envs([("VK_DRIVER_FILES", "/no/driver"), ("VK_ICD_FILENAMES", "/no/driver")])
        .output()
        .expect("the program runs")
        .into();
    done.fails(&["no graphics card", "mesa-vulkan-drivers", "processor"]);
    assert!(!folder.path().join("p.png").exists());
}

#[test]
fn the_demo_shows_everything() {
    let folder = folder();
    let text = run(folder.path(), "demo --out {a/b} --scale 0.05").ok();
    for what in ["triangles", "16-bit shadow map", "lookups", "ok: ", "city.png"] {
        assert!(text.contains(what), "no {what} in\n{text}");
    }
    assert_eq!(size_of_png(&folder.path().join("a/b/city.png")), (1280, 720));
    run(folder.path(), "validate {a/b/city.antumbra}").ok();
}

#[test]
fn lamps_have_maps_and_surfaces_send_their_light_on() {
    let folder = folder();
    run(folder.path(), "scene cellar --scale 0.05 -o {cellar.glb} --quiet").ok();
    let line = "render {cellar.glb} -o {p.png} --size 64x36 --samples 1";
    let draw = |options: &str| {
        run(folder.path(), &format!("{line} {options}")).ok();
        image::open(folder.path().join("p.png")).expect("a picture").to_rgb8()
    };
    let unlike = |a: &image::RgbImage, b: &image::RgbImage| {
        let far = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 4);
        a.pixels().zip(b.pixels()).filter(|pair| far(*pair)).count()
    };
    let pixels = 64 * 36;
    for projection in ["cube", "paraboloid"] {
        let [card, processor] =
            ["gpu", "cpu"].map(|device| draw(&format!("--device {device} --lamp-maps {projection}")));
        assert!(unlike(&card, &processor) < pixels / 50, "{projection}");
        // Maps of 512 texels show much the same as rays.
        let rays = draw("--device cpu");
        assert!(unlike(&processor, &rays) < pixels / 10, "{projection}");
    }
    let [without, with] = ["--device gpu --lamp-maps cube", "--device gpu --virtual-lights 16"].map(draw);
    assert!(unlike(&without, &with) > pixels / 4, "virtual lights change nothing");
    let by_rays = draw("--device cpu --virtual-lights 16");
    assert!(unlike(&by_rays, &with) < pixels / 5, "virtual lights by rays and by maps");
    run(folder.path(), &format!("{line} --virtual-lights 0")).misused("1..=4096");
    run(folder.path(), &format!("{line} --lamp-map-size 63 --lamp-maps cube")).misused("64..=4096");
    run(folder.path(), &format!("{line} --lamp-maps sphere")).misused("paraboloid");
    run(folder.path(), &format!("{line} --day --virtual-lights 8")).misused("--day");
}
