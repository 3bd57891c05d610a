//! Sheets of conditions as somebody fills them in.

/// A sheet as CSV, with the needed values as measured.
pub fn filled(sheet: &[u8]) -> Vec<u8> {
    let mut reader = csv::Reader::from_reader(sheet);
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|known| known == name).unwrap();
    let mut filled = csv::Writer::from_writer(Vec::new());
    filled.write_record(&header).unwrap();
    for record in reader.records() {
        let record = record.unwrap();
        let mut cells: Vec<String> = record.iter().map(str::to_owned).collect();
        if &record[column("quantity")] != "surface" {
            cells[column("value")] = record[column("_needed")].to_owned();
        }
        for (name, text) in [("sigma", "0"), ("source", "tape"), ("date", "2026-11-23"), ("licence", "ODbL-1.0")] {
            cells[column(name)] = text.to_owned();
        }
        filled.write_record(&cells).unwrap();
    }
    filled.into_inner().unwrap()
}
