//! Real time: the renderer on a graphics card, by wgpu.
//!
//! Its passes are the twins of those on the CPU, in the same folders, and give the same pictures.

mod device;

pub use device::{Gpu, Kernel, Slot};
