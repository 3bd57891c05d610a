//! Finds the edges that a vehicle can reach over certified edges and turns, and the edges from which it can come back.
//!
//! The graph and the restrictions are those of routes. Each edge and turn is certified by itself; whole routes are not. The
//! same functions answer what would be reachable if one more edge were safe ([`with_edge`]).

use super::graph::{Access, BARRED, Graph, SearchState};
use crate::network::{EdgeNo, MovementKind};

/// The reachable edges.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReachableEdges {
    /// By edge: whether a way leads there. An arc that is driven only as part of a passage does not count.
    pub there: Vec<bool>,
    /// By edge: whether a way leads there and another leads back to the beginning.
    pub and_back: Vec<bool>,
}

/// The parts of the network in which a vehicle can drive from every edge to every other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Components {
    /// By edge: its component. Components are numbered by size; 0 has the most edges. `None` if the edge may not be used.
    pub of: Vec<Option<u32>>,
    /// Number of components.
    pub count: usize,
}

/// The edges that can be reached from any of the edges `starts`.
#[must_use]
pub fn reach(graph: &Graph, access: &Access, starts: &[EdgeNo]) -> ReachableEdges {
    let usable = |edge: &&EdgeNo| access.edges.get(edge.index()).is_some_and(|&cost| cost != BARRED);
    let first: Vec<SearchState> = starts.iter().filter(usable).filter_map(|&edge| graph.first(edge)).collect();
    let mut steps: Vec<(SearchState, SearchState)> = Vec::new();
    let mut flood_ahead = |first: &[SearchState]| {
        steps.clear();
        flood(graph.states(), first, |state, visit| {
            for step in graph.steps(access, state) {
                steps.push((step.next, state));
                visit(step.next);
            }
        })
    };
    let seen = flood_ahead(&first);
    // The way back begins where the way there ends: that is a destination.
    let rested = |states: &[bool]| -> Vec<SearchState> {
        let states = states.iter().enumerate().filter(|(_, on)| **on);
        states.map(|(state, _)| graph.after_stop(state as SearchState)).collect()
    };
    if !graph.ends_only().is_empty() {
        flood_ahead(&rested(&seen));
    }
    steps.sort_unstable();
    let home: Vec<SearchState> = first.iter().flat_map(|&state| graph.arrivals(state)).collect();
    let returning = flood(graph.states(), &home, |state, visit| {
        let from = steps.partition_point(|step| step.0 < state);
        steps[from..].iter().take_while(|step| step.0 == state).for_each(|step| visit(step.1));
    });
    let back = |(state, &there): (usize, &bool)| there && returning[graph.after_stop(state as SearchState) as usize];
    let returning: Vec<bool> = seen.iter().enumerate().map(back).collect();
    let edges = |states: &[bool]| {
        let mut edges = vec![false; graph.network().edges.len()];
        for (state, _) in states.iter().enumerate().filter(|(_, on)| **on) {
            if let Some(edge) = edges.get_mut(graph.edge_of(state as SearchState).index()) {
                *edge = true;
            }
        }
        edges
    };
    ReachableEdges { there: edges(&seen), and_back: edges(&returning) }
}

fn flood(
    states: usize,
    first: &[SearchState],
    mut step: impl FnMut(SearchState, &mut dyn FnMut(SearchState)),
) -> Vec<bool> {
    let mut seen = vec![false; states];
    let mut open: Vec<SearchState> = Vec::new();
    for &state in first {
        if !std::mem::replace(&mut seen[state as usize], true) {
            open.push(state);
        }
    }
    while let Some(state) = open.pop() {
        step(state, &mut |next| {
            if !std::mem::replace(&mut seen[next as usize], true) {
                open.push(next);
            }
        });
    }
    seen
}

/// The access if an edge and every lawful turn and passage into and out of it were safe.
#[must_use]
pub fn with_edge(graph: &Graph, access: &Access, edge: EdgeNo) -> Access {
    let mut opened = access.clone();
    if let Some(slot) = opened.edges.get_mut(edge.index()) {
        *slot = 0;
    }
    for (slot, movement) in opened.movements.iter_mut().zip(graph.movements().all()) {
        let touches = movement.from == edge || movement.to == edge;
        if touches && movement.kind != MovementKind::UTurn && movement.forbidden.is_none() {
            *slot = 0;
        }
    }
    for (slot, passage) in opened.passages.iter_mut().zip(graph.movements().passages()) {
        if (passage.from == edge || passage.to == edge) && passage.forbidden.is_none() {
            *slot = 0;
        }
    }
    opened
}

/// The strongly connected components of the usable edges (Tarjan 1972, without recursion). Restrictions over ways are ignored,
/// so a component may be a little too large. Roads that are open to a destination only join no other roads.
#[must_use]
pub fn components(graph: &Graph, access: &Access) -> Components {
    let edges = graph.network().edges.len();
    let usable = |edge: EdgeNo| access.edges[edge.index()] != BARRED;
    let next = |edge: EdgeNo| {
        let first = graph.movements().first(edge);
        let ends_only = graph.ends_only();
        let movements = graph.movements().after(edge).iter().enumerate().filter_map(move |(i, movement)| {
            let open = access.movements[first + i] != BARRED && !ends_only.leads_out([edge, movement.to]);
            (open && usable(movement.to)).then_some(movement.to)
        });
        let passages = graph.movements().over(edge).filter_map(move |(place, p)| {
            let driven = [edge].into_iter().chain(p.through.iter().copied()).chain([p.to]);
            let open = access.passages[place] != BARRED && !ends_only.leads_out(driven);
            (open && usable(p.to)).then_some(p.to)
        });
        movements.chain(passages)
    };
    const NEW: u32 = u32::MAX;
    let (mut number, mut low, mut on_stack) = (vec![NEW; edges], vec![0_u32; edges], vec![false; edges]);
    let (mut stack, mut found, mut count) = (Vec::new(), vec![NEW; edges], 0_u32);
    let mut counter = 0;
    for root in EdgeNo::first(edges).filter(|&edge| usable(edge)) {
        if number[root.index()] != NEW {
            continue;
        }
        let mut open = vec![(root, 0_usize)];
        while let Some((edge, child)) = open.last_mut() {
            let e = edge.index();
            if *child == 0 && number[e] == NEW {
                (number[e], low[e]) = (counter, counter);
                counter += 1;
                stack.push(*edge);
                on_stack[e] = true;
            }
            if let Some(to) = next(*edge).nth(*child) {
                *child += 1;
                if number[to.index()] == NEW {
                    open.push((to, 0));
                } else if on_stack[to.index()] {
                    low[e] = low[e].min(number[to.index()]);
                }
                continue;
            }
            if low[e] == number[e] {
                while let Some(top) = stack.pop() {
                    on_stack[top.index()] = false;
                    found[top.index()] = count;
                    if top.index() == e {
                        break;
                    }
                }
                count += 1;
            }
            open.pop();
            if let Some((parent, _)) = open.last() {
                low[parent.index()] = low[parent.index()].min(low[e]);
            }
        }
    }
    by_size(&found, count as usize, NEW)
}

fn by_size(found: &[u32], count: usize, new: u32) -> Components {
    let mut sizes = vec![0_usize; count];
    let mut least = vec![usize::MAX; count];
    for (edge, &component) in found.iter().enumerate().filter(|(_, component)| **component != new) {
        sizes[component as usize] += 1;
        least[component as usize] = least[component as usize].min(edge);
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(sizes[i]), least[i]));
    let mut rank = vec![0_u32; count];
    for (place, &component) in order.iter().enumerate() {
        rank[component] = place as u32;
    }
    let of = found.iter().map(|&component| (component != new).then(|| rank[component as usize])).collect();
    Components { of, count }
}
