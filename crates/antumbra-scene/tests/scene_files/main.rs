//! Scene files in and out: small files built here feature by feature, hostile bytes, and the real scenes.

mod builder;
mod compressed;
mod geometry;
mod hostile;
mod looks;
mod nodes;
mod obj;
mod round_trip;
mod shared_scenes;
