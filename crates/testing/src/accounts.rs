//! The sums that the account of any reading must satisfy.

use netcert::osm::pbf::ReadAccount;

pub fn assert_adds_up(account: &ReadAccount) {
    assert_eq!(account.ways_read, account.ways_kept + account.ways_left_out.values().sum::<u64>());
    let n = account.nodes;
    assert_eq!(n.read, n.placed + n.unnamed + n.deleted + n.invalid + n.superseded);
    assert_eq!(n.named, n.placed + n.invalid + n.missing);
}
