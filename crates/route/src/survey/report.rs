//! A survey as JSON, and as rows and features that `netcert evidence add` reads when they are filled in.

use serde_json::{Map, Value, json};

use super::{Opens, Survey};
use crate::conditions::{Condition, ConditionAt};
use crate::driver::Driver;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::Policy;
use crate::words::Named as _;

/// What a survey says, and what it does not.
pub const SURVEY_SCOPE: &str = "No permit, and no certificate. Edges and turns are certified as if every value were measured as named; \
                                whole routes are not, so a route over them may still fail.";

/// The columns that a survey adds to those of a sheet. A register of measurements ignores them.
pub const SURVEY_COLUMNS: [&str; 7] = ["_rank", "_opens", "_total", "_unit", "_assumed_from", "_lon", "_lat"];

/// One thing to measure, with what its step opens.
#[derive(Debug, Clone, Copy)]
pub struct SurveyLine<'s> {
    /// The number of the line, from 1.
    pub number: usize,
    /// The number of the step, from 1.
    pub rank: usize,
    /// What the step opens, in the unit of the survey.
    pub opens: f64,
    /// What is opened with all steps up to this one.
    pub total: f64,
    /// What is to be measured.
    pub condition: &'s Condition,
}

impl Survey {
    /// What the numbers count: `m` or `pairs`.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self.opens {
            Opens::Metres => "m",
            Opens::Pairs => "pairs",
        }
    }

    /// Everything that is to be measured, in order of the steps.
    pub fn lines(&self) -> impl Iterator<Item = SurveyLine<'_>> {
        let all = (1..).zip(&self.steps).flat_map(|(rank, step)| step.conditions().map(move |c| (rank, step, c)));
        (1..).zip(all).map(|(number, (rank, step, condition))| SurveyLine {
            number,
            rank,
            opens: step.opens,
            total: step.reachable - self.before,
            condition,
        })
    }

    /// The survey as JSON.
    #[must_use]
    pub fn json(&self, network: &Network, driver: &Driver) -> Value {
        let mut number = 0;
        let mut steps = Vec::new();
        for (rank, step) in (1..).zip(&self.steps) {
            let mut places = Vec::new();
            for conditions in &step.places {
                let mut measure = Vec::new();
                for condition in conditions {
                    number += 1;
                    let mut members = condition.members(network, number);
                    members["assumed_from"] = json!(condition.assumed_from(network));
                    measure.push(members);
                }
                let first = conditions.first();
                places.push(json!({
                    "title": first.map(|condition| condition.title(network)),
                    "place": first.and_then(|condition| condition.place(network)),
                    "measure": measure,
                }));
            }
            let total = step.reachable - self.before;
            steps.push(json!({
                "rank": rank,
                "opens": step.opens,
                "total": total,
                "reachable": step.reachable,
                "places": places,
            }));
        }
        json!({
            "vehicle_id": driver.model.vehicle.id,
            "corridor": driver.permits.settings.policy.name(),
            "unit": self.unit(),
            "all": self.all,
            "reachable_before": self.before,
            "steps": steps,
            "hopeless": self.hopeless,
            "gave_up": self.gave_up,
            "scope": SURVEY_SCOPE,
        })
    }
}

impl SurveyLine<'_> {
    /// The cells of [`SURVEY_COLUMNS`].
    #[must_use]
    pub fn cells(&self, unit: &str, network: &Network) -> [Value; 7] {
        let place = self.condition.place(network);
        let of = |part: usize| json!(place.map(|place| place[part]));
        [
            json!(self.rank),
            json!(tenths(self.opens)),
            json!(tenths(self.total)),
            json!(unit),
            json!(self.condition.assumed_from(network)),
            of(0),
            of(1),
        ]
    }

    /// The cells by name.
    #[must_use]
    pub fn members(&self, unit: &str, network: &Network) -> Map<String, Value> {
        let names = SURVEY_COLUMNS.iter().map(|name| (*name).to_owned());
        names.zip(self.cells(unit, network)).collect()
    }
}

/// Decimetres are enough for a length of roads.
fn tenths(number: f64) -> f64 {
    (number * 10.0).round() / 10.0
}

impl Condition {
    /// Where the assumed value comes from: a source of widths, or `assumed` or `surveyed` for a kerb. `None` if nothing is assumed.
    #[must_use]
    pub fn assumed_from(&self, network: &Network) -> Option<&'static str> {
        let edge = |edge: EdgeNo| network.edges.get(edge.index());
        match &self.at {
            ConditionAt::Road(edges) => {
                let policy = *Policy::ALL.iter().find(|policy| super::width_of(**policy) == self.quantity)?;
                let strips = edges.iter().filter_map(|&on| network.section(edge(on)?).strip(policy));
                strips.map(|strip| strip.source).min().map(crate::words::Named::name)
            }
            ConditionAt::Corner { node, between: [from, to] } => {
                let surveyed = network.site_kerb_m(*node, [edge(*from)?, edge(*to)?]).is_some();
                Some(if surveyed { "surveyed" } else { "assumed" })
            }
            ConditionAt::Junction(_) => None,
        }
    }
}
