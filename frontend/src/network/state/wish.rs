//! What somebody might want a unit to do, as the page names it.

use shared::ddc100::checklist::Wish;
use shared::device::Device;

/// The wish that a word of the page means: `open`, `move`, `engage-3`. `percent` is where to move.
#[must_use]
pub fn from_key(key: &str, percent: u8) -> Option<Wish> {
    let relay = |prefix: &str| key.strip_prefix(prefix)?.parse::<u8>().ok();
    Some(match key {
        "open" => Wish::Open,
        "close" => Wish::Close,
        "stop" => Wish::Stop,
        "move" => Wish::MoveTo(percent),
        "start-esd" => Wish::StartEsd,
        "stop-esd" => Wish::StopEsd,
        _ => match (relay("engage-"), relay("disengage-")) {
            (Some(number), _) => Wish::Engage(number),
            (_, Some(number)) => Wish::Disengage(number),
            _ => return None,
        },
    })
}

/// The words to choose from that a type knows, with what the type calls them.
#[must_use]
pub fn choices(kind: Device) -> Vec<(String, String)> {
    let mut keys: Vec<String> = ["open", "close", "stop", "move"]
        .into_iter()
        .map(str::to_owned)
        .collect();
    for number in 1..=7 {
        keys.push(format!("engage-{number}"));
        keys.push(format!("disengage-{number}"));
    }
    keys.extend(["start-esd", "stop-esd"].map(str::to_owned));
    let known = |key: String| {
        let wish = from_key(&key, 50)?;
        let mut name = wish.name(kind)?;
        if matches!(wish, Wish::MoveTo(_)) {
            "Move to a position".clone_into(&mut name);
        }
        Some((key, name))
    };
    keys.into_iter().filter_map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_have_their_own_relays() {
        let keys =
            |kind| -> Vec<String> { choices(kind).into_iter().map(|(key, _)| key).collect() };
        let mx = keys(Device::Ddc100Mx);
        assert!(mx.contains(&"open".into()) && mx.contains(&"move".into()));
        assert!(mx.contains(&"engage-7".into()));
        assert!(mx.contains(&"start-esd".into()) && mx.contains(&"stop-esd".into()));
        let io = keys(Device::Ddc100Io);
        assert!(!io.contains(&"start-esd".into()), "{io:?}");
        assert!(!io.contains(&"open".into()), "{io:?}");
        assert!(io.contains(&"engage-3".into()));
        // Reading D2: relay 3 is AS-3 on an MX/DDC.
        let names = choices(Device::Ddc100Mx);
        let as_3 = names.iter().find(|(key, _)| key == "engage-3").unwrap();
        assert!(as_3.1.contains("AS-3"), "{}", as_3.1);
    }

    #[test]
    fn words_are_understood() {
        assert_eq!(from_key("move", 61), Some(Wish::MoveTo(61)));
        assert_eq!(from_key("disengage-4", 0), Some(Wish::Disengage(4)));
        assert_eq!(from_key("engage-x", 0), None);
        assert_eq!(from_key("", 0), None);
    }
}
