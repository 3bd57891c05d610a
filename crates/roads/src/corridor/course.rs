//! The line of a stroke as it is driven: approach, edges and unrolled loops, without jogs that only the map has.

use super::Params;
use super::merge::{Jog, Relaid, Split};
use super::polyline::Polyline;
use super::stretch::Across;
use super::taper::Ramp;
use crate::network::{Edge, EdgeNo, Splits};

/// Length driven after the counted turn, metres. It exceeds any catalogued vehicle, so the last unit leaves the turn
/// too.
const TAIL_M: f64 = 60.0;
/// Length smoothed with a closed stroke beyond its tail, metres. It keeps the free end far from the counted part.
const BEYOND_M: f64 = 150.0;
/// Most turns round a closed stroke, before and after the counted turn.
const MOST_TURNS: usize = 12;

/// An edge of the chain: its place in the frame, and its widths.
pub(super) struct ChainLink<'n> {
    pub(super) index: EdgeNo,
    pub(super) edge: &'n Edge,
    /// The positions that are driven, in direction of travel.
    pub(super) points: &'n [[f64; 2]],
    /// How many positions of the edge lie before them: the approach begins within its first edge.
    pub(super) skipped: usize,
    /// `None` if no width is known.
    pub(super) room: Option<Room>,
    /// All lanes of the direction of travel.
    pub(super) direction: Option<Across>,
    pub(super) two_way: bool,
    /// Metres of taper along the road per metre across.
    pub(super) ratio: f64,
}

/// The strips of an edge under a policy, across the way's line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    pub(super) strip: Across,
    /// The lanes of the direction. A lane may shift within them.
    pub(super) shift: Across,
    /// Everything that is paved.
    pub(super) surface: Across,
}

/// What a link is driven for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Before the stroke, or before the turn round it that counts.
    LeadIn,
    /// Its edge is certified there.
    Counted,
    /// After the turn that counts.
    Tail,
}

/// A link on the line to be smoothed, at arc lengths `from..to`. A link may come several times.
pub(super) struct DrivenLink {
    pub(super) link: usize,
    pub(super) role: Role,
    pub(super) from: f64,
    pub(super) to: f64,
    /// Arc length of every vertex of the link.
    pub(super) at: Vec<f64>,
    /// Lateral distance of the line without jogs from the map's line, metres to the left.
    pub(super) aside_m: f64,
}

/// The line of the chain as driven.
pub(super) struct ChainLine {
    pub(super) line: Polyline,
    pub(super) driven: Vec<DrivenLink>,
    /// Arc length at which the corridor ends. The line beyond it is for smoothing only.
    pub(super) end: f64,
}

pub(super) fn open_course(links: &[ChainLink<'_>], approach: usize) -> ChainLine {
    let mut course = ChainLine { line: Polyline::default(), driven: Vec::with_capacity(links.len()), end: 0.0 };
    for link in 0..links.len() {
        course.drive(links, link, if link >= approach { Role::Counted } else { Role::LeadIn });
    }
    course.end = course.line.length();
    course
}

/// Unrolls a loop. Enough of its edges precede the counted turn that a vehicle enters it fully articulated, and enough
/// follow that its last unit leaves it.
pub(super) fn closed_course(links: &[ChainLink<'_>], params: &Params) -> ChainLine {
    let n = links.len();
    let length = |link: usize| -> f64 {
        links[link].points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum()
    };
    let count = |asked_m: f64, nth: &dyn Fn(usize) -> usize| {
        let mut sum = 0.0;
        (0..MOST_TURNS * n)
            .take_while(|&i| {
                let more = sum < asked_m;
                sum += length(nth(i));
                more
            })
            .count()
    };
    let before = count(params.lead_in_m, &|i| n - 1 - i % n);
    let tail = count(TAIL_M, &|i| i % n);
    let beyond = count(TAIL_M + BEYOND_M, &|i| i % n);
    let mut course = ChainLine { line: Polyline::default(), driven: Vec::with_capacity(before + n + beyond), end: 0.0 };
    for i in 0..before {
        course.drive(links, n - 1 - (before - 1 - i) % n, Role::LeadIn);
    }
    for link in 0..n {
        course.drive(links, link, Role::Counted);
    }
    for i in 0..beyond {
        if i == tail {
            course.end = course.line.length();
        }
        course.drive(links, i % n, Role::Tail);
    }
    if course.end <= 0.0 {
        course.end = course.line.length();
    }
    course
}

impl ChainLine {
    fn drive(&mut self, links: &[ChainLink<'_>], link: usize, role: Role) {
        let at: Vec<f64> = links[link].points.iter().map(|&p| self.line.push(p)).collect();
        let (from, to) = (at.first().copied().unwrap_or(0.0), at.last().copied().unwrap_or(0.0));
        self.driven.push(DrivenLink { link, role, from, to, at, aside_m: 0.0 });
    }

    /// Removes the jogs of the line where two carriageways meet a road. Returns the jogs, placed on the new line, and
    /// the ramps by which the new line lies beside the map's.
    pub(super) fn straighten(&mut self, links: &[ChainLink<'_>], splits: &Splits) -> (Vec<Jog>, Vec<Ramp>) {
        let found: Vec<(usize, Jog)> = (1..self.driven.len())
            .filter_map(|after| Some((after, self.split(links, splits, after)?.jog(&self.line)?)))
            .collect();
        let mut jogs: Vec<Jog> = found.iter().map(|(_, jog)| *jog).collect();
        if jogs.is_empty() {
            return (jogs, Vec::new());
        }
        let Some(relaid) = Relaid::new(&self.line, &jogs) else { return (Vec::new(), Vec::new()) };
        let aside = jogs.iter().flat_map(|jog| relaid.back(jog)).collect();
        for (after, jog) in &found {
            let (before, behind) = self.driven.split_at_mut(*after);
            let carriageway = if jog.ahead { behind } else { before };
            carriageway.iter_mut().for_each(|one| one.aside_m += jog.shift_m);
        }
        for one in &mut self.driven {
            (one.from, one.to) = (relaid.at(one.from), relaid.at(one.to));
            one.at.iter_mut().for_each(|u| *u = relaid.at(*u));
        }
        self.end = relaid.at(self.end);
        for jog in &mut jogs {
            jog.at = relaid.at(jog.at);
        }
        self.line = relaid.line;
        (jogs, aside)
    }

    /// The split between the previous piece and the piece `after`, if the road parts or joins there.
    fn split(&self, links: &[ChainLink<'_>], splits: &Splits, after: usize) -> Option<Split> {
        let link = |one: &DrivenLink| links.get(one.link);
        let (a, b) = (link(self.driven.get(after - 1)?)?, link(self.driven.get(after)?)?);
        let (ahead, two_way, one_way) = match (a.two_way, b.two_way) {
            (true, false) if splits.parts_after(a.index) => (true, a, b),
            (false, true) if splits.joined_before(b.index) => (false, b, a),
            _ => return None,
        };
        let one_way_m = |driven: &mut dyn Iterator<Item = &DrivenLink>| -> f64 {
            let carriageway = driven.take_while(|one| link(one).is_some_and(|link| !link.two_way));
            carriageway.map(|one| one.to - one.from).sum()
        };
        Some(Split {
            at: self.driven.get(after)?.from,
            ahead,
            two_way: two_way.direction?,
            one_way: one_way.direction?,
            one_way_m: if ahead {
                one_way_m(&mut self.driven[after..].iter())
            } else {
                one_way_m(&mut self.driven[..after].iter().rev())
            },
            ratio: two_way.ratio.max(one_way.ratio),
        })
    }
}
