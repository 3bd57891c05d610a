//! Extracts. The first byte says how the rest is meant: even, a whole file; odd, the messages of up to three blocks, which the target frames,
//! so that the fuzzer need not keep lengths and checksums right. An accepted extract keeps what `Extract` promises of its arrays. Where the
//! first byte asks for it, the file is also read blob by blob, and a second time with the same result.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_fuzz::{check_extract, file, one_thread};
use netcert_osm::osm::pbf::{self, copy::Blobs, write};

fuzz_target!(init: one_thread(), |bytes: &[u8]| {
    let Some((&mode, rest)) = bytes.split_first() else { return };
    let path = file("extract.osm.pbf", &if mode & 1 == 0 { rest.to_vec() } else { framed(mode, rest) });
    let read = pbf::read_extract(&path, &|_| ());
    if mode & 8 != 0
        && let Ok(mut blobs) = Blobs::open(&path, &|_, _| ()) {
        while let Ok(Some(blob)) = blobs.next_blob() {
            let _ = blobs.contents(&blob);
        }
    }
    let Ok(extract) = read else { return };
    check_extract(&extract);
    if mode & 16 == 0 {
        return;
    }
    let again = pbf::read_extract(&path, &|_| ()).expect("what was read");
    assert_eq!(format!("{extract:?}"), format!("{again:?}"));
});

/// A file with these messages as its blocks: each after its length in two bytes, the last one to the end. The bits of `mode` choose what the
/// header claims, and compression.
fn framed(mode: u8, rest: &[u8]) -> Vec<u8> {
    let header: &[u8] = if mode & 2 == 0 { HEADER } else { SORTED };
    let blob = if mode & 4 == 0 { write::raw_blob } else { write::zlib_blob };
    let mut out = Vec::new();
    write::frame(&mut out, "OSMHeader", &write::raw_blob(header));
    let mut rest = rest;
    for _ in 0..2 {
        let Some(([high, low], more)) = rest.split_first_chunk() else { break };
        let length = usize::from(u16::from_be_bytes([*high, *low]));
        let Some((block, more)) = more.split_at_checked(length) else { break };
        write::frame(&mut out, "OSMData", &blob(block));
        rest = more;
    }
    write::frame(&mut out, "OSMData", &blob(rest));
    out
}

/// Required features.
const HEADER: &[u8] = b"\x22\x0eOsmSchema-V0.6\x22\x0aDenseNodes";
/// The same, and the claim that objects are sorted.
const SORTED: &[u8] = b"\x22\x0eOsmSchema-V0.6\x22\x0aDenseNodes\x2a\x11Sort.Type_then_ID";
