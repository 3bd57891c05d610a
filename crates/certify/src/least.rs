//! The least number for which something does: of whole numbers, or of a list.

/// A whole number above `fails` and at most `most` for which `does` holds, while it fails for the number below. The search
/// starts at `first` and strides outwards, then halves the interval.
#[must_use]
pub fn least_that_does(fails: i64, first: i64, most: i64, does: impl Fn(i64) -> bool) -> Option<i64> {
    let (mut low, mut high) = (fails, first.clamp(fails + 1, most.max(fails + 1)));
    let mut stride = 2;
    if does(high) {
        // Down in growing strides until a number fails.
        while high - low > stride && does(high - stride) {
            high -= stride;
            stride *= 2;
        }
        low = low.max(high - stride);
    } else {
        while !does(high) {
            if high >= most {
                return None;
            }
            low = high;
            high = (high + stride).min(most);
            stride *= 2;
        }
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if does(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// The least of some growing numbers that does, if the greatest does.
#[must_use]
pub fn least_of(numbers: &[f64], mut does: impl FnMut(&f64) -> bool) -> Option<f64> {
    let (mut high, mut low) = (numbers.len().checked_sub(1)?, None);
    if !does(&numbers[high]) {
        return None;
    }
    while low.map_or(0, |low: usize| low + 1) < high {
        let middle = usize::midpoint(low.map_or(0, |low| low + 1), high);
        let middle = middle.min(high - 1);
        if does(&numbers[middle]) { high = middle } else { low = Some(middle) }
    }
    numbers.get(high).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_is_found_from_wherever_the_search_begins() {
        for least in 1..60 {
            for first in 0..70 {
                assert_eq!(least_that_does(0, first, 60, |n| n >= least), Some(least), "{least} from {first}");
            }
        }
        assert_eq!(least_that_does(0, 5, 60, |_| false), None);
        assert_eq!(least_that_does(7, 5, 7, |n| n >= 8), Some(8));
    }
}
