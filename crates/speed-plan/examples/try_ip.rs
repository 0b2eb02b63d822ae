fn main() {
    for file in std::env::args().skip(1) {
        let case = speed_plan::Case::from_json(&std::fs::read_to_string(&file).unwrap(), &file).unwrap();
        print!("{} ", case.name);
        speed_plan::try_ip(&case);
    }
}
