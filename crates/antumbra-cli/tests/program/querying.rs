//! query: arrays in, an array out.

use std::fs;
use std::path::Path;

use antumbra::{Filter, Prefilter, ShadowFile};
use glam::DVec3;
use npyz::WriterBuilder;

use crate::folder::{arguments, folder, run};

fn write_points(path: &Path, points: &[DVec3]) {
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::new().default_dtype().shape(&[points.len() as u64, 3]);
    let mut writer = options.writer(&mut bytes).begin_nd().expect("a header");
    writer.extend(points.iter().flat_map(|p| p.to_array())).expect("numbers");
    writer.finish().expect("an end");
    fs::write(path, bytes).expect("a file");
}

fn read_values(path: &Path) -> Vec<f32> {
    let bytes = fs::read(path).expect("a file");
    npyz::NpyFile::new(&bytes[..]).expect("an array").into_vec().expect("float32")
}

/// Points over the city, some far off, and two that are none.
fn points() -> Vec<DVec3> {
    let mut points: Vec<DVec3> = (0..5000)
        .map(|i| f64::from(i) * DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5))
        .map(|p| (p.fract() - DVec3::new(0.5, 0.2, 0.5)) * DVec3::new(300.0, 100.0, 300.0))
        .collect();
    points.extend([DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e300)]);
    points
}

#[test]
fn levels_of_detail_and_blockers_are_the_runtimes_own() {
    let folder = folder();
    let points = points();
    write_points(&folder.path().join("p.npy"), &points);
    let bake = "bake {city} -o {b} --resolution 512 --levels --enter-depths --interior thickness=0.5";
    run(folder.path(), bake).ok();
    run(folder.path(), "validate {b}").ok();
    let bytes = fs::read(folder.path().join("b")).expect("a bake");
    let file = ShadowFile::from_bytes(&bytes).expect("a sound bake");
    let sun = file.light("sun").expect("a sun");
    let values = |options: &str| {
        let done = run(folder.path(), &format!("query {{b}} --light sun --points {{p.npy}} -o {{v.npy}} {options}"));
        assert!(done.stderr.contains("--interior thickness"), "no word of the policy: {}", done.stderr);
        read_values(&folder.path().join("v.npy"))
    };
    let expected = |lookup: &dyn Fn(DVec3) -> f32| points.iter().map(|p| lookup(*p)).collect::<Vec<f32>>();
    let means = expected(&|p| sun.mean_visibility(p, None, 4));
    assert!(means.iter().any(|v| *v > 0.0 && *v < 1.0));
    assert_eq!(values("--lod 4"), means);
    assert_eq!(values("--footprint 3"), expected(&|p| sun.prefiltered(p, None, 3.0, Prefilter::Mean)));
    let filter = Filter::new_box(3).expect("odd");
    let on_levels = expected(&|p| sun.level_filtered(p, None, filter, 1.5));
    assert_eq!(values("--lod 1.5 --prefilter levels --filter 3"), on_levels);
    let blockers = values("--blocker 2");
    assert_eq!(blockers.len(), 2 * points.len());
    for (pair, point) in blockers.chunks(2).zip(&points) {
        match sun.blocker(*point, 2.0) {
            Some(b) => assert_eq!(pair, [b.least_m as f32, b.greatest_m as f32]),
            None => assert!(pair.iter().all(|v| v.is_nan())),
        }
    }
    run(folder.path(), "bake {city} -o {graph} --resolution 512 --encoding dag8").ok();
    for (line, words) in [
        ("--lod 1.5", "whole number"),
        ("--lod 1 --prefilter levels", "--levels"),
        ("--blocker 1", "--enter-depths"),
        ("--continuous", "--encoding silhouette"),
    ] {
        run(folder.path(), &format!("query {{graph}} --light sun --points {{p.npy}} -o {{v.npy}} {line}"))
            .fails(&[words]);
    }
}

#[test]
fn answers_are_the_runtimes_own() {
    let folder = folder();
    let points = points();
    let normals = vec![DVec3::Y; points.len()];
    write_points(&folder.path().join("p.npy"), &points);
    write_points(&folder.path().join("n.npy"), &normals);
    let bytes = fs::read(&arguments(folder.path(), "{baked}")[0]).expect("a bake");
    let file = ShadowFile::from_bytes(&bytes).expect("a sound bake");
    let sun = file.light("sun").expect("a sun");
    let query = "query {baked} --light sun --points {p.npy} -o {v.npy}";
    let values = |options: &str| {
        run(folder.path(), &format!("{query} {options}")).ok();
        read_values(&folder.path().join("v.npy"))
    };
    let plain: Vec<f32> = points.iter().map(|p| sun.visibility(*p)).collect();
    assert!(plain.contains(&0.0) && plain.contains(&1.0));
    assert_eq!(values(""), plain);
    assert_eq!(values("--threads 3"), plain);
    assert_eq!(plain[5000..5002], [1.0; 2]);
    let filter = Filter::new_tent(5).expect("odd");
    let soft: Vec<f32> = points.iter().map(|p| sun.filtered(*p, None, filter)).collect();
    assert_eq!(values("--filter 5 --kernel tent"), soft);
    // Between texels some answers are not those of voxels.
    let continuous: Vec<f32> = points.iter().map(|p| sun.filtered(*p, None, Filter::continuous())).collect();
    assert_ne!(continuous, plain);
    assert_eq!(values("--continuous"), continuous);
    let filter = Filter::new_box(3).expect("odd");
    let lifted: Vec<f32> = points.iter().map(|p| sun.filtered(*p, Some(DVec3::Y), filter)).collect();
    assert_eq!(values("--filter 3 --normals {n.npy}"), lifted);
}

#[test]
fn segments_give_their_lit_shares() {
    let folder = folder();
    let (points, mut ends) = (points(), points());
    ends.rotate_right(777);
    write_points(&folder.path().join("p.npy"), &points);
    write_points(&folder.path().join("t.npy"), &ends);
    let bytes = fs::read(&arguments(folder.path(), "{baked}")[0]).expect("a bake");
    let file = ShadowFile::from_bytes(&bytes).expect("a sound bake");
    let sun = file.light("sun").expect("a sun");
    let line = "query {baked} --light sun --points {p.npy} --to {t.npy} -o {v.npy}";
    let told = run(folder.path(), &format!("{line} --json")).json();
    assert_eq!((&told["segments"], told.get("points")), (&5003.into(), None));
    let values = read_values(&folder.path().join("v.npy"));
    assert_eq!(values.len(), points.len());
    // Marching misses each end of a shadow by less than its step.
    let samples = 2000;
    for i in (0..5000).step_by(50) {
        let (from, to) = (points[i], ends[i]);
        let at = |s: i32| from + (to - from) * ((f64::from(s) + 0.5) / f64::from(samples));
        let lit: f32 = (0..samples).map(|s| sun.visibility(at(s))).sum();
        let runs = if from.is_finite() && to.is_finite() { sun.segment(from, to).count() } else { 0 };
        let error = (lit / samples as f32 - values[i]).abs();
        assert!(error <= (runs + 1) as f32 / samples as f32, "segment {i}: off by {error} with {runs} runs");
    }
    assert!(values.iter().any(|v| *v > 0.0 && *v < 1.0));
    write_points(&folder.path().join("t.npy"), &ends[1..]);
    run(folder.path(), line).fails(&["5002 ends for the 5003 points"]);
    for conflict in ["--normals {p.npy}", "--filter 3", "--lod 1"] {
        run(folder.path(), &format!("{line} {conflict}")).misused("cannot be used with");
    }
}

#[test]
fn json_tells_the_rate() {
    let folder = folder();
    write_points(&folder.path().join("p.npy"), &points());
    let line = "query {baked} --light sun --points {p.npy} -o {v.npy} --json --threads 1";
    let told = run(folder.path(), line).json();
    assert_eq!((&told["points"], &told["threads"]), (&5003.into(), &1.into()));
    assert!(told["lookups_per_second"].as_f64() > Some(0.0));
    write_points(&folder.path().join("p.npy"), &[]);
    let told = run(folder.path(), line).json();
    assert_eq!((&told["points"], &told["lookups_per_second"]), (&0.into(), &0.0.into()));
    assert!(read_values(&folder.path().join("v.npy")).is_empty());
}

#[test]
fn bad_arrays_are_refused() {
    let folder = folder();
    write_points(&folder.path().join("p.npy"), &points());
    write_points(&folder.path().join("n.npy"), &[DVec3::Y]);
    let query = "query {baked} --light sun -o {v.npy} --points";
    run(folder.path(), &format!("{query} {{p.npy}} --normals {{n.npy}}")).fails(&["1 normals for the 5003 points"]);
    run(folder.path(), &format!("{query} {{baked}}")).fails(&["no .npy file"]);
    let whole = fs::read(folder.path().join("p.npy")).expect("a file");
    for length in [0, 5, 9, 11, 60, whole.len() - 1] {
        fs::write(folder.path().join("d.npy"), &whole[..length]).expect("a file");
        run(folder.path(), &format!("{query} {{d.npy}}")).fails(&["d.npy cannot be used: it"]);
    }
    assert!(!folder.path().join("v.npy").exists());
}
