// From thresholds to voxels: twin of `scan`. A workgroup makes 128 bits of one plane's texels, all columns of them: bits
// where shadow begins, and then their prefix OR along alpha, by 32 stretches of columns for each of four words.

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read> thresholds: array<u32>;
// By VPL, theta, alpha, then quads of phi.
@group(0) @binding(2) var<storage, read_write> voxels: array<vec4<u32>>;

const MOST_COLUMNS: u32 = 512u;

var<workgroup> words: array<atomic<u32>, 4u * MOST_COLUMNS>;
var<workgroup> totals: array<u32, 128>;

@compute @workgroup_size(128)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let theta = group.x;
    let quad = group.z;
    for (var i = local; i < 4u * batch.alpha; i += 128u) {
        atomicStore(&words[i], 0u);
    }
    workgroupBarrier();
    let phi = 128u * quad + local;
    if phi < batch.phi {
        let column = thresholds[(group.y * batch.theta + theta) * batch.phi + phi];
        if column < batch.alpha {
            atomicOr(&words[4u * column + local / 32u], 1u << (local & 31u));
        }
    }
    workgroupBarrier();
    let word = local & 3u;
    let stretch = local >> 2u;
    let columns = (batch.alpha + 31u) / 32u;
    let begin = stretch * columns;
    let end = min(begin + columns, batch.alpha);
    var dark = 0u;
    for (var column = begin; column < end; column++) {
        dark |= atomicLoad(&words[4u * column + word]);
    }
    totals[local] = dark;
    workgroupBarrier();
    dark = 0u;
    for (var before = word; before < local; before += 4u) {
        dark |= totals[before];
    }
    for (var column = begin; column < end; column++) {
        let at = 4u * column + word;
        dark |= atomicLoad(&words[at]);
        atomicStore(&words[at], dark);
    }
    workgroupBarrier();
    let row = (group.y * batch.theta + theta) * batch.alpha;
    for (var column = local; column < batch.alpha; column += 128u) {
        let at = 4u * column;
        voxels[(row + column) * batch.quads + quad] = vec4(
            atomicLoad(&words[at]), atomicLoad(&words[at + 1u]), atomicLoad(&words[at + 2u]), atomicLoad(&words[at + 3u]),
        );
    }
}
