//! Reads an extract and prints the time of each part: `read_extract FILE.osm.pbf`. For `benches/reading.sh`.

#![allow(clippy::print_stdout)]

use std::{path::PathBuf, sync::Mutex, time::Instant};

use netcert::osm::pbf::{Progress, ReadingStage, read_extract};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args_os().nth(1).map(PathBuf::from).ok_or("usage: read_extract FILE.osm.pbf")?;
    let start = Instant::now();
    let ends: Mutex<Vec<(ReadingStage, f64)>> = Mutex::default();
    let note = |progress: Progress| {
        let Ok(mut ends) = ends.lock() else { return };
        if ends.last().is_none_or(|(stage, _)| *stage != progress.stage) {
            ends.push((progress.stage, 0.0));
        }
        if let Some((_, end)) = ends.last_mut() {
            *end = start.elapsed().as_secs_f64();
        }
    };
    let extract = read_extract(&path, &note)?;
    for row in extract.account.rows() {
        println!("{:>10} {} {} {}", row.count, row.item, row.outcome, row.reason);
    }
    for (stage, end) in ends.lock().map_err(|error| error.to_string())?.iter() {
        println!("{stage:?} until {end:.2} s");
    }
    println!(
        "reading {:.2} s, {} references, blake3 {}",
        start.elapsed().as_secs_f64(),
        extract.refs.len(),
        extract.account.blake3
    );
    println!("{} bytes a way", size_of::<netcert::osm::Way>());
    Ok(())
}
