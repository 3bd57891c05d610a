//! Certifies a way with what its sections need. Beside each other sections may need more than each by itself: a wider road has another
//! middle, and a turn that begins there another path. Where sections fail, or the whole, more is supposed there.

use super::failing::failing;
use super::fitter::{Fitted, Fitter, Fitting};
use super::sections::Section;
use super::suppositions::Suppositions;
use crate::assemble::DrivenWay;
use crate::stop::{Stop, Stopped};

/// How often more is supposed.
const MENDS: usize = 4;

/// A way and its sections.
#[derive(Clone, Copy)]
pub(super) struct Parted<'a> {
    pub(super) way: &'a DrivenWay<'a>,
    pub(super) sections: &'a [Section],
    /// By section, what makes it safe without regard to how much that is.
    pub(super) more: &'a [Suppositions],
}

impl Fitter {
    /// The way, certified under what is supposed and what else turns out to be needed, as if it were measured. Where it stays uncertified: the
    /// way with all that was supposed last.
    pub(super) fn mended(
        &mut self,
        parted: &Parted<'_>,
        mut supposed: Suppositions,
        stop: &Stop,
    ) -> Result<Result<Fitted, Suppositions>, Stopped> {
        for round in 0..MENDS {
            let tried = self.each_as_measured(parted.sections, &supposed, stop)?;
            let failed: Vec<usize> = (0..tried.len()).filter(|&at| tried[at].is_none()).collect();
            let before = supposed.clone();
            if failed.is_empty() {
                let own: Vec<Fitting> = tried.into_iter().flatten().collect();
                let mut whole = self.joined(parted.way, parted.sections, &own);
                whole.supposed.add(&supposed);
                whole.round = round;
                if self.safe_or_helped(&mut whole, stop)? {
                    // What was certified in between may have been made under less. The answer is made from nothing that was made before.
                    if let Some(certified) = self.fresh(&whole, stop)? {
                        return Ok(Ok(whole.fitted(certified)));
                    }
                    break;
                }
                supposed = whole.supposed;
            } else if round == 0 {
                failed.iter().for_each(|&at| supposed.add(&parted.more[at]));
            } else {
                self.help_sections(parted.sections, &failed, &mut supposed, stop)?;
            }
            if supposed == before {
                break;
            }
            // More for one section may be nearly what its road needs elsewhere. Later tries are made with no more than was asked for.
            if round == 0 {
                supposed.level_roads(&self.roads.network, &parted.way.drive.edges);
            }
        }
        Ok(Err(supposed))
    }

    /// Whether the whole is safe. Else more is supposed where it fails.
    fn safe_or_helped(&mut self, whole: &mut Fitting, stop: &Stop) -> Result<bool, Stopped> {
        let Ok(looked) = self.look(whole, stop)? else { return Ok(false) };
        for place in failing(&looked) {
            self.help(whole, &place, stop)?;
        }
        Ok(looked.safe())
    }

    /// Supposes more for some sections, until each is safe under it.
    fn help_sections(
        &mut self,
        sections: &[Section],
        failed: &[usize],
        supposed: &mut Suppositions,
        stop: &Stop,
    ) -> Result<(), Stopped> {
        let all = &*supposed;
        let helped = self.together(failed.len(), |fitter, i| {
            let way = sections[failed[i]].way();
            let mut fitting = Fitting { supposed: all.clone(), ..Fitting::new(&fitter.base, &way) };
            fitter.suppose_until_safe(&mut fitting, stop)?;
            Ok(fitting.supposed)
        })?;
        helped.iter().for_each(|more| supposed.add(more));
        Ok(())
    }
}
