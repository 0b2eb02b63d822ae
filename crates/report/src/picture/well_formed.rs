/// Checks that every tag is closed, that attributes are quoted and that no bare `<` or `&` is left; returns the number of elements.
pub(super) fn assert_well_formed(document: &str) -> usize {
    let mut open = Vec::new();
    let mut elements = 0;
    let mut rest = document;
    while let Some((before, after)) = rest.split_once('<') {
        assert!(!before.contains('>'), "{before}");
        for entity in before.split('&').skip(1) {
            assert!(
                ["amp;", "lt;", "gt;", "quot;", "apos;"]
                    .iter()
                    .any(|known| entity.starts_with(known)),
                "{entity}"
            );
        }
        let (tag, next) = after.split_once('>').expect("tag without end");
        assert!(
            !tag.contains('<') && tag.matches('"').count() % 2 == 0,
            "{tag}"
        );
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else {
            elements += 1;
            if !tag.ends_with('/') {
                open.push(tag.split_whitespace().next().expect("tag without name"));
            }
        }
        rest = next;
    }
    assert!(open.is_empty() && rest.trim().is_empty());
    elements
}
