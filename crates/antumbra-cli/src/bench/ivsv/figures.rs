//! The paper's figures, of our scene: rows of pictures, each held against its truth.

use antumbra_render::Picture;
use antumbra_render::area::{AreaLight, AreaLighting, AreaShape, AreaTechnique, Interpolation, VoxelResolution};
use anyhow::{Context, Result};
use image::RgbImage;
use serde_json::json;

use super::super::plot::file_name;
use super::super::report::Image;
use super::super::section::{Column, Section, Shown, row};
use super::Study;
use super::studio::{Studio, rmse};
use crate::progress::Progress;

/// A row of pictures.
struct Figure {
    /// Of the file.
    name: &'static str,
    /// Its numbers in the paper.
    theirs: &'static str,
    pictures: Vec<Shot>,
}

/// A picture to be drawn.
struct Shot {
    label: &'static str,
    how: AreaLighting,
    in_fog: bool,
}

const COLUMNS: &[Column<'_>] = &[
    ("figure", "figure", Shown::Plain),
    ("theirs", "in the paper", Shown::Plain),
    ("name", "picture", Shown::Plain),
    ("rmse", "error", Shown::Decimal),
];

/// Draws all figures, and says how far off each picture is.
pub fn draw(
    studio: &mut Studio,
    base: &AreaLighting,
    study: &Study,
    progress: &Progress,
) -> Result<(Section, Vec<Image>)> {
    let about = format!(
        "{}, {} VPLs unless the picture says otherwise. From left to right; errors are root mean squares of 255 against the same \
light traced.",
        studio.about(),
        base.vpls,
    );
    let mut section = Section::new("Figures", about, COLUMNS);
    let figures = figures(base);
    let mut images = Vec::new();
    progress.count("figures", figures.len() as u64, "figures");
    for figure in &figures {
        let mut pictures = Vec::new();
        for shot in &figure.pictures {
            let picture = studio.picture(&shot.how, shot.in_fog)?;
            let truth = studio.traced(&shot.how, shot.in_fog)?;
            let mut row = row(json!({
                "table": "figures", "scene": study.name, "figure": figure.name, "theirs": figure.theirs, "name": shot.label,
            }));
            // What is without shadows on purpose is not held against the truth.
            if shot.how.technique != AreaTechnique::None {
                row.insert("rmse".to_owned(), rmse(&picture, &truth).into());
            }
            section.rows.push(row);
            pictures.push(picture.rgb().to_vec());
            if figure.name == "truth" {
                pictures.push(truth.rgb().to_vec());
                pictures.push(difference(&picture, &truth));
            }
        }
        images.push(beside(study, figure.name, &pictures, studio.size())?);
        progress.set(images.len() as u64, figures.len() as u64);
    }
    Ok((section, images))
}

fn figures(base: &AreaLighting) -> Vec<Figure> {
    let shot = |label, how: AreaLighting| Shot { label, how, in_fog: true };
    let sized = |label, voxels| shot(label, AreaLighting { voxels, ..base.clone() });
    let cube = VoxelResolution::cube;
    let single = |label, voxels| shot(label, AreaLighting { vpls: 1, voxels, ..base.clone() });
    let few = |label, interpolation| shot(label, AreaLighting { vpls: 8, interpolation, ..base.clone() });
    let lit = |label, change: &dyn Fn(&mut AreaLight)| {
        let mut how = base.clone();
        how.lights.iter_mut().for_each(change);
        shot(label, how)
    };
    let without = AreaLighting { technique: AreaTechnique::None, ..base.clone() };
    let clear = Shot { label: "clear air", how: base.clone(), in_fog: false };
    let moved = |label, share| lit(label, &|light| moved(light, share));
    let resized = |label, factor| lit(label, &|light| resized(light, factor));
    vec![
        Figure {
            name: "media",
            theirs: "1, 10",
            pictures: vec![clear, shot("fog without shadows", without), shot("fog", base.clone())],
        },
        Figure {
            name: "point-and-area",
            theirs: "2",
            pictures: vec![single("a point, 256 samples", cube(256)), shot("all of the light", base.clone())],
        },
        Figure {
            name: "resolution",
            theirs: "6",
            pictures: vec![
                sized("32 samples", cube(32)),
                sized("64", cube(64)),
                sized("128", cube(128)),
                sized("256", cube(256)),
            ],
        },
        Figure {
            name: "alpha",
            theirs: "7, 8, 9",
            pictures: vec![
                single("a point, 512 samples but 32 of alpha", VoxelResolution { alpha: 32, ..cube(512) }),
                single("128 of alpha", VoxelResolution { alpha: 128, ..cube(512) }),
                single("128 of all", cube(128)),
                single("512 of all", cube(512)),
            ],
        },
        Figure {
            name: "moving",
            theirs: "10",
            pictures: vec![
                moved("0.45 widths to the left", -0.45),
                moved("0.15", -0.15),
                moved("0.15 to the right", 0.15),
                moved("0.45", 0.45),
            ],
        },
        Figure {
            name: "sizes",
            theirs: "11",
            pictures: vec![resized("a quarter of the size", 0.25), resized("as it is", 1.0), resized("twice", 2.0)],
        },
        Figure { name: "truth", theirs: "12", pictures: vec![shot("ours, truth, 4 x difference", base.clone())] },
        Figure {
            name: "interpolation",
            theirs: "13",
            pictures: vec![
                few("8 points, nearest voxel", Interpolation::None),
                few("interpolated", Interpolation::Fast),
            ],
        },
    ]
}

/// To the right, by a share of its width.
fn moved(light: &mut AreaLight, share: f64) {
    let width_m = match light.shape {
        AreaShape::Rectangle { width_m, .. } => width_m,
        AreaShape::Disc { radius_m } | AreaShape::Sphere { radius_m } => 2.0 * radius_m,
        AreaShape::Environment => 0.0,
    };
    light.position_world -= light.direction_world.cross(light.up_world) * (share * width_m);
}

/// Larger or smaller, and as bright in all.
fn resized(light: &mut AreaLight, factor: f64) {
    light.shape = match light.shape {
        AreaShape::Rectangle { width_m, height_m } => {
            AreaShape::Rectangle { width_m: factor * width_m, height_m: factor * height_m }
        }
        AreaShape::Disc { radius_m } => AreaShape::Disc { radius_m: factor * radius_m },
        AreaShape::Sphere { radius_m } => AreaShape::Sphere { radius_m: factor * radius_m },
        AreaShape::Environment => return,
    };
    light.luminance = light.luminance.map(|l| l / (factor * factor) as f32);
}

/// How two pictures differ, four times as strong about grey.
fn difference(a: &Picture, b: &Picture) -> Vec<u8> {
    let off = |(a, b): (&u8, &u8)| (128 + 4 * (i32::from(*a) - i32::from(*b))).clamp(0, 255) as u8;
    a.rgb().iter().zip(b.rgb()).map(off).collect()
}

/// Pictures side by side.
fn beside(study: &Study, name: &str, pictures: &[Vec<u8>], [width, height]: [u32; 2]) -> Result<Image> {
    const GAP: u32 = 4;
    let count = pictures.len() as u32;
    let mut sheet = RgbImage::from_pixel(count * width + (count - 1) * GAP, height, image::Rgb([255; 3]));
    for (i, rgb) in (0..).zip(pictures) {
        let picture = RgbImage::from_raw(width, height, rgb.clone()).context("a picture lacks pixels")?;
        image::imageops::replace(&mut sheet, &picture, i64::from(i * (width + GAP)), 0);
    }
    let mut bytes = std::io::Cursor::new(Vec::new());
    sheet.write_to(&mut bytes, image::ImageFormat::Png)?;
    Ok(Image { file_name: file_name("ivsv", &study.name, name).replace(".svg", ".png"), bytes: bytes.into_inner() })
}
