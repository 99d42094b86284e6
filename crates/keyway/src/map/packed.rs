//! Conversion of bytes to bits.

/// Packs a test of at most 64 bytes into bits, the first byte lowest: 64 bytes cost some hundred
/// instructions.
pub(super) fn packed(bytes: &[u8], is_set: impl Fn(u8) -> bool) -> u64 {
    let mut flags = [0; 64];
    // A fixed length lets the compiler compare many bytes at once.
    match bytes.first_chunk::<64>() {
        Some(bytes) => mark(&mut flags, bytes, is_set),
        None => mark(&mut flags, bytes, is_set),
    }
    let (eights, _) = flags.as_chunks::<8>();
    eights.iter().rev().fold(0, |word, &eight| word << 8 | gathered(u64::from_le_bytes(eight)))
}

#[inline]
fn mark(flags: &mut [u8; 64], bytes: &[u8], is_set: impl Fn(u8) -> bool) {
    for (flag, &byte) in flags.iter_mut().zip(bytes) {
        *flag = u8::from(is_set(byte));
    }
}

/// Gathers the lowest bits of eight bytes that are 0 or 1: byte k is moved up by 56 - 7 k.
const fn gathered(flags: u64) -> u64 {
    flags.wrapping_mul(0x0102_0408_1020_4080) >> 56
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_byte_has_its_bit(bytes in prop::collection::vec(any::<u8>(), 0..=64), least: u8) {
            let word = packed(&bytes, |byte| byte >= least);
            for at in 0..64 {
                let expected = bytes.get(at).is_some_and(|&byte| byte >= least);
                prop_assert_eq!(word >> at & 1 == 1, expected, "{}", at);
            }
        }
    }
}
