//! The shaders are valid WGSL, and their structs lie in memory as the Rust ones do: without any driver.

use std::mem::offset_of;

use antumbra::Encoding;
use antumbra::shaders::{GpuLight, Lookup, source};
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn validated(text: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    validator.validate(&module).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    module
}

#[test]
fn every_way_to_bind_them_is_valid() {
    for pages in [1, 2, 7] {
        for (top_grid, counting) in [(true, false), (false, true)] {
            for encoding in [Encoding::Dag8, Encoding::Silhouette] {
                let lookup = Lookup { encoding, group: 2, binding: 3, pages, log2_page_words: 20, top_grid, counting };
                let module = validated(&source(&lookup));
                let bindings = module.global_variables.iter().filter_map(|(_, v)| v.binding);
                let at: Vec<_> = bindings.map(|b| (b.group, b.binding)).collect();
                assert_eq!(at, (3..4 + pages).map(|binding| (2, binding)).collect::<Vec<_>>());
            }
        }
    }
}

#[test]
fn names_begin_with_the_prefix() {
    for encoding in [Encoding::Dag8, Encoding::Silhouette] {
        check_names(&validated(&source(&Lookup { encoding, ..Lookup::default() })));
    }
}

fn check_names(module: &naga::Module) {
    let functions = module.functions.iter().filter_map(|(_, f)| f.name.as_deref());
    let types = module.types.iter().filter_map(|(_, t)| t.name.as_deref());
    let constants = module.constants.iter().filter_map(|(_, c)| c.name.as_deref());
    let globals = module.global_variables.iter().filter_map(|(_, v)| v.name.as_deref());
    for name in functions.chain(types).chain(constants).chain(globals) {
        assert!(name.to_lowercase().starts_with("antumbra"), "{name} may clash with names of the shader around it");
    }
}

/// Offset of a member of a struct in a module, by their names.
fn offset(module: &naga::Module, structure: &str, member: &str) -> usize {
    let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(structure));
    let naga::TypeInner::Struct { members, .. } = &found.expect("the struct").1.inner else { panic!("no struct") };
    members.iter().find(|m| m.name.as_deref() == Some(member)).expect("the member").offset as usize
}

#[test]
fn a_light_lies_in_memory_as_the_shader_reads_it() {
    let module = validated(&source(&Lookup::default()));
    macro_rules! offsets {
        ($($member:ident)*) => { [$((stringify!($member), offset_of!(GpuLight, $member))),*] };
    }
    let offsets = offsets!(row_x row_y row_z whole fraction kind log2_resolution faces first_face levels enters enter_log2
        enter_shift texel slice texels_per_tangent near_m log2_near slices_per_octave ndc_near_share cone_cosine);
    for (member, at) in offsets {
        assert_eq!(offset(&module, "AntumbraLight", member), at, "{member}");
    }
    let (_, light) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("AntumbraLight")).expect("the light");
    let naga::TypeInner::Struct { members, span } = &light.inner else { panic!("no struct") };
    assert_eq!((members.len(), *span as usize), (offsets.len(), size_of::<GpuLight>()));
    assert_eq!(size_of::<GpuLight>(), 144);
}
