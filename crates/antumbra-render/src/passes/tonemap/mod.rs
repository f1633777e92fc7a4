//! From radiance to what a screen shows: exposure, a film-like curve, sRGB.

pub(crate) mod reference;
