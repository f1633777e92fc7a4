//! A graphics card that goes away is noticed, and another opening brings it back.

use antumbra_render::gpu::Gpu;
use antumbra_testbed::gpu;

#[test]
fn a_lost_card_is_noticed() {
    let card = gpu();
    let buffer = card.buffer("numbers", &[1u32, 2, 3]);
    assert_eq!(card.read::<u32>(&buffer).expect("numbers"), [1, 2, 3]);
    assert!(!card.is_lost());
    card.device.destroy();
    // The callback comes when the card is next asked.
    let _ = card.device.poll(wgpu::PollType::Poll);
    assert!(card.is_lost());
    let again = Gpu::open().expect("a card");
    assert!(!again.is_lost());
}
