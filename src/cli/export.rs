//! `netcert export`: writes the roads and turns that a vehicle may use, for routing engines and map programs.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use netcert::export::formats::{self, GeoParquetVersion, Layer, Options, TARGETS};
use netcert::export::{self, ExportError, Out, PermitPolicy, Source, Tally, Target, Unfinished};
use netcert::osm::facts::WidthSource;
use netcert::store::Database;

use super::Session;
use crate::cli::arguments::relative::RelativeArgs;
use crate::cli::arguments::values::{metres, word};
use crate::cli::arguments::vehicle_args::{PolicyArgs, TimeArgs, VehicleArgs};
use crate::cli::database::DatabaseArgs;
use crate::cli::database::on_demand::{self, Coverage};
use crate::cli::output::file::check_place;
use crate::cli::output::{grouped, printable, results};
use crate::cli::session::stop::when_stopped;

/// Write the roads and turns that a vehicle may use in the format of a routing engine or map program.
///
/// An edge or turn is permitted if access is lawful and its certificate is safe. Everything else is refused, also
/// what is not certified. The header of every output, or a file beside it, names the vehicle, the options and the hash
/// of the database. A vehicle that this database has not certified yet is certified first.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert export osrm --vehicle EU-SEMI16.5 --extract heidelberg.osm.pbf --out permits/
  netcert export osm-pbf --vehicle US-WB67 --extract columbus.osm.pbf --out columbus-wb67.osm.pbf
  netcert export csv --vehicle AU-ATRIPLE53 --layer edges --out - | head
  netcert export geojson --vehicle AU-BDOUBLE26 --relative-to AU-SEMI19 --out compared/

docs/export/ has a page for each target. The page leads from the download to a routed truck and
lists what the engine cannot express. An output is never left incomplete. The folder of an earlier
export is replaced.")]
pub(crate) struct Export {
    /// The format to write.
    #[arg(value_name = "TARGET", value_parser = target_names())]
    target: &'static str,
    #[command(flatten)]
    db: DatabaseArgs,
    #[command(flatten)]
    vehicle: VehicleArgs,
    /// The file or folder to write; the target says which of the two. `-` is standard output.
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
    /// The extract that the database was made from. Targets that rewrite the extract or need its node ids ask for it.
    #[arg(long, value_name = "REGION.osm.pbf")]
    extract: Option<PathBuf>,
    /// Write only this layer, as one file, where the target writes both layers.
    #[arg(long, value_name = "LAYER", value_parser = layer())]
    layer: Option<Layer>,
    /// The version of GeoParquet, for the target geoparquet [default: 1.1]. In 2.0 lines have Parquet's own type GEOMETRY.
    #[arg(long, value_name = "VERSION", value_parser = geoparquet_version())]
    geoparquet: Option<GeoParquetVersion>,
    /// Permit only edges and turns with at least this RSC: the metres to spare at the tightest place.
    #[arg(long, value_name = "METRES", default_value_t = 0.0, value_parser = metres)]
    min_rsc: f64,
    #[command(flatten)]
    relative: RelativeArgs,
    /// Permit only edges whose width comes from this source or a better one; the list runs from worst to best.
    #[arg(long, value_name = "SOURCE", value_parser = word::<WidthSource>())]
    width_source: Option<WidthSource>,
    #[command(flatten)]
    time: TimeArgs,
    #[command(flatten)]
    policy: PolicyArgs,
}

fn target_names() -> impl TypedValueParser<Value = &'static str> {
    let value = |target: &&dyn Target| PossibleValue::new(target.name()).help(target.about());
    PossibleValuesParser::new(TARGETS.iter().map(value))
        .try_map(|name| formats::named(&name).map(Target::name).ok_or("no such target"))
}

fn layer() -> impl TypedValueParser<Value = Layer> {
    PossibleValuesParser::new(["edges", "turns"]).map(|name| if name == "turns" { Layer::Turns } else { Layer::Edges })
}

fn geoparquet_version() -> impl TypedValueParser<Value = GeoParquetVersion> {
    let named = |name: String| GeoParquetVersion::ALL.iter().copied().find(|version| version.name() == name);
    PossibleValuesParser::new(GeoParquetVersion::ALL.iter().map(|version| version.name()))
        .try_map(move |name| named(name).ok_or("no such version"))
}

impl Export {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let target = formats::named(self.target).ok_or_else(|| anyhow::anyhow!("{}: no such target", self.target))?;
        let path = self.db.path()?;
        for input in [Some(&path), self.extract.as_ref()].into_iter().flatten() {
            if same(input, &self.out) {
                return Err(ExportError::OwnInput(self.out.clone()).into());
            }
        }
        let to_stream = self.out.as_os_str() == "-";
        if !to_stream {
            check_place(&self.out)?;
        }
        formats::check_reference(target, self.relative.relative_to.as_deref())?;
        anyhow::ensure!(
            self.geoparquet.is_none() || target.name() == "geoparquet",
            "{}: --geoparquet is for the target geoparquet; leave it out",
            target.name()
        );
        self.relative.check(&path, &self.vehicle.id, self.policy.corridor)?;
        let source = self.source(session, &path)?;
        let out = if to_stream { Out::Stream(Box::new(results())) } else { Out::Path(self.out.clone()) };
        let unfinished = Unfinished::default();
        let on_disk = unfinished.clone();
        when_stopped(|| on_disk.remove());
        let options = Options { layer: self.layer, geoparquet: self.geoparquet.unwrap_or_default() };
        match export::export(&source, target, &options, out, unfinished) {
            // Kept as an I/O error: `main` then recognises a closed pipe, which is no failure.
            Err(ExportError::Write(error)) => return Err(error.into()),
            done => done?,
        }
        session.progress.say(&counts("edges", &source.permitted.edge_tally));
        session.progress.say(&counts("turns", &source.permitted.turn_tally));
        if !to_stream {
            session.progress.say(&format!("{}: written", self.out.display()));
        }
        if let Some(words) = source.header.provenance.measurements.words() {
            session.progress.say(&printable(&words));
        }
        session.progress.say(&source.header.scope());
        Ok(())
    }

    fn source<'s>(&self, session: &'s Session, path: &Path) -> anyhow::Result<Source<'s>> {
        let database = Database::open(path)?;
        let required = self.vehicle.required(self.policy.corridor, Coverage::EdgesAndTurns, "export");
        let (database, set) = on_demand::certified(session, path, database, &required)?;
        database.close()?;
        let ask = export::Ask {
            db: path.to_owned(),
            vehicle: self.vehicle.id.clone(),
            policy: set.policy,
            rule: PermitPolicy { min_rsc_m: self.min_rsc, min_width_source: self.width_source },
            at: self.time.at,
            extract: self.extract.clone(),
            relative_to: self.relative.relative_to.clone(),
        };
        Ok(Source::open(ask, &session.progress)?)
    }
}

fn same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn counts(what: &str, tally: &Tally) -> String {
    let mut refused: Vec<(&String, &u64)> = tally.refused.iter().collect();
    refused.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
    let refused: Vec<String> = refused.iter().map(|(words, n)| format!("{words} {}", grouped(**n))).collect();
    let (permitted, total) = (grouped(tally.permitted), grouped(tally.total()));
    format!("{permitted} of {total} {what} permitted; refused: {}", refused.join(", "))
}
