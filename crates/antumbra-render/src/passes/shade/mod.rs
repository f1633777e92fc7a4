//! From surfaces and the light on them to radiance.
//!
//! Lambert's diffuse reflection and the microfacet highlight of glTF 2.0 (appendix B: GGX, Smith, Schlick), haze over
//! the distance, and the sky behind it all.

pub(crate) mod reference;
