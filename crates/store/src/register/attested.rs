//! Where vehicles are attested to go: by rows `drivable_by` of the register, and by signs and networks that the map names
//! (`data/designations.toml`).
//!
//! A turn is attested by a sign if the road that it leaves and the road that it enters have the same one.

use std::collections::{BTreeMap, BTreeSet};

use crate::database::Database;
use crate::error::StoreError;
use crate::file::blob;
use crate::osm::facts::{Countries, Designation, Designations};
use crate::register::known_vehicles::KnownVehicle;
use netcert_rows::{Attestation, AttestedBy};

type Sql<T> = Result<T, sqlx::Error>;

/// The edges that have a designation.
struct Signed {
    designation: &'static Designation,
    edges: Vec<u32>,
}

impl Database {
    /// Where a vehicle is attested to go. The register comes first, then designations in the order of their file.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn attestations(&mut self, vehicle: &str) -> Result<Vec<Attestation>, StoreError> {
        let mut all = Vec::new();
        let known = self.register_vehicles()?.remove(vehicle);
        let signed = self.signed_edges(|designation| designation.vehicles.iter().any(|id| id == vehicle))?;
        let turns = if known.is_none() && signed.is_empty() { Vec::new() } else { self.turn_ends()? };
        if let Some(KnownVehicle { edges, turns: of }) = known {
            let of = of.iter().filter_map(|&turn| turns.get(turn as usize).copied());
            all.push(Attestation { by: AttestedBy::Register, edges, turns: sorted(of) });
        }
        for Signed { designation, edges } in signed {
            let turns = sorted(signed_turns(&edges, &turns).map(|(_, ends)| ends));
            all.push(Attestation { by: AttestedBy::Designation(designation), edges, turns });
        }
        Ok(all)
    }

    /// Whether a vehicle may be attested somewhere: a designation names it, whether or not a road here has that designation, or the register does.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn may_be_attested(&mut self, vehicle: &str) -> Result<bool, StoreError> {
        if Designations::builtin().all().iter().any(|designation| designation.vehicles.iter().any(|id| id == vehicle)) {
            return Ok(true);
        }
        self.session.run(async |c| {
            let sql = "SELECT EXISTS (SELECT 1 FROM evidence WHERE quantity = 'drivable_by' AND state = 'matched' AND vehicle = ?)";
            let row: Sql<bool> = sqlx::query_scalar(sql).bind(vehicle).fetch_one(c).await;
            row
        })
    }

    /// The vehicles that are attested to go somewhere, by id.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(crate) fn attested_vehicles(&mut self) -> Result<BTreeMap<String, KnownVehicle>, StoreError> {
        let mut all = self.register_vehicles()?;
        let signed = self.signed_edges(|_| true)?;
        let turns = if signed.is_empty() { Vec::new() } else { self.turn_ends()? };
        for Signed { designation, edges } in signed {
            let of: Vec<u32> = signed_turns(&edges, &turns).map(|(turn, _)| turn).collect();
            for id in &designation.vehicles {
                let known = all.entry(id.clone()).or_default();
                merge(&mut known.edges, &edges);
                merge(&mut known.turns, &of);
            }
        }
        Ok(all)
    }

    /// The edges of each designation that some edge has.
    fn signed_edges(&mut self, wanted: impl Fn(&Designation) -> bool) -> Result<Vec<Signed>, StoreError> {
        let known = Designations::builtin().all().iter().filter(|designation| wanted(designation));
        let mut signed: Vec<Signed> = known.map(|designation| Signed { designation, edges: Vec::new() }).collect();
        if signed.is_empty() {
            return Ok(signed);
        }
        // Other edges, of which there may be many more, are left out before their shapes are read.
        let values: BTreeSet<&str> = signed.iter().map(|one| one.designation.first_value()).collect();
        let some = vec!["instr(e.legal_tags, '=' || ?) > 0"; values.len()].join(" OR ");
        let sql = format!(
            "SELECT e.fid - 1, r.country, e.legal_tags, e.geom FROM edge AS e JOIN road AS r ON r.road_no = e.road_no \
             WHERE e.legal_tags IS NOT NULL AND ({some}) ORDER BY e.fid"
        );
        let rows = self.session.run(async |c| {
            let query = sqlx::query_as::<_, (u32, String, String, Vec<u8>)>(sqlx::AssertSqlSafe(sql));
            values.into_iter().fold(query, sqlx::query::QueryAs::bind).fetch_all(c).await
        })?;
        let path = self.session.path.clone();
        let countries = Countries::load()
            .map_err(|error| StoreError::NotThere { path: path.clone(), detail: error.to_string() })?;
        for (edge, country, tags, geom) in rows {
            let of: Vec<&mut Signed> = signed.iter_mut().filter(|one| one.designation.signed(Some(&tags))).collect();
            if of.is_empty() {
                continue;
            }
            let shape = blob::decode(&geom).unwrap_or_default();
            let Some(at) = shape.first() else {
                return Err(StoreError::Damaged { path, detail: format!("the geometry of edge {}", edge + 1) });
            };
            let regions = countries.regions(*at);
            of.into_iter()
                .filter(|one| one.designation.holds_in(&country, &regions))
                .for_each(|one| one.edges.push(edge));
        }
        signed.retain(|one| !one.edges.is_empty());
        Ok(signed)
    }

    /// The first and the last edge of every turn, in order of the network.
    fn turn_ends(&mut self) -> Result<Vec<[u32; 2]>, StoreError> {
        self.session.run(async |c| {
            let sql = "SELECT from_fid - 1, to_fid - 1 FROM turn ORDER BY fid";
            let rows: Sql<Vec<(u32, u32)>> = sqlx::query_as(sql).fetch_all(c).await;
            Ok(rows?.into_iter().map(|(from, to)| [from, to]).collect())
        })
    }
}

/// The turns between two of these sorted edges, with their indices.
fn signed_turns<'t>(edges: &'t [u32], turns: &'t [[u32; 2]]) -> impl Iterator<Item = (u32, [u32; 2])> + 't {
    let signed = |edge: &u32| edges.binary_search(edge).is_ok();
    (0..).zip(turns).filter(move |(_, ends)| ends.iter().all(signed)).map(|(turn, ends)| (turn, *ends))
}

fn sorted<T: Ord>(all: impl Iterator<Item = T>) -> Vec<T> {
    all.collect::<BTreeSet<T>>().into_iter().collect()
}

fn merge(known: &mut Vec<u32>, others: &[u32]) {
    *known = sorted(known.iter().chain(others).copied());
}
