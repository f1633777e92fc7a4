//! Real time: the renderer on a graphics card, by wgpu.
//!
//! Its passes are the twins of those on the CPU, in the same folders, and give the same pictures.

mod area;
mod baked;
mod blit;
mod csm;
mod culling;
mod device;
mod frame;
mod lamp_maps;
mod passes;
mod renderer;
mod scene;
mod sheets;
mod targets;
mod timing;

pub use device::{ADVICE, Gpu, Kernel, Slot};
pub use renderer::{GpuRenderer, LampLists, Lookup, Setting};
pub use timing::PassTime;
