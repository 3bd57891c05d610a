//! Draws the demo region: `data/demo/region.toml` → `data/demo.osm.pbf`.
//!
//!     cargo run --example draw_region [SOURCE.toml [OUT.osm.pbf]]
//!
//! The same source gives the same file. The head of the source describes its format.

#![allow(clippy::print_stdout)]

mod alignment;
mod junctions;
mod region;

use anyhow::Context as _;

fn main() -> anyhow::Result<()> {
    let mut args = std::env::args().skip(1);
    let source = args.next().unwrap_or_else(|| "data/demo/region.toml".into());
    let out = args.next().unwrap_or_else(|| "data/demo.osm.pbf".into());
    let text = std::fs::read_to_string(&source).with_context(|| format!("cannot read {source}"))?;
    let map = region::draw(&text).with_context(|| source.clone())?;
    let bytes = netcert::osm::pbf::write::write_extract(&map.nodes, &map.ways);
    std::fs::write(&out, &bytes).with_context(|| format!("cannot write {out}"))?;
    println!("{}: {} ways, {} nodes, {:.1} km → {out}", map.name, map.ways.len(), map.nodes.len(), map.length_m / 1e3);
    Ok(())
}
