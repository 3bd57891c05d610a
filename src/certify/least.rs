//! The least number for which something does.

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
