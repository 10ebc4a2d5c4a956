use super::*;

/// The lines of a text as they are read.
fn rows(text: &str) -> Option<Vec<String>> {
    let lines = Vec::from_iter(text.lines().map(|line| line.as_bytes().to_vec()));
    let cells = Cells::detect(&lines)?;
    let rewritten = |line: &Vec<u8>| cells.row(line).unwrap_or(line.clone());
    let text = |line| String::from_utf8(line).unwrap();
    Some(lines.iter().map(rewritten).map(text).collect())
}

fn expect(text: &str, expected: &[&str]) {
    let found = rows(text).unwrap_or_else(|| panic!("as usual: {text}"));
    assert_eq!(found, expected, "{text}");
}

#[test]
fn decimal_commas() {
    expect(
        "t;gx;n\n0,02;-1,5e-3;7\n0,04;2;8\n",
        &["t;gx;n", "0.02;-1.5e-3;7", "0.04;2;8"],
    );
    expect("0,02\t1,5\t7\n", &["0.02\t1.5\t7"]);
    expect("0,02 1,5 -7,25\n", &["0.02 1.5 -7.25"]);
    expect(
        "t,gx,gy\n\"0,02\",\"1,5\",\"3\"\n",
        &["t,gx,gy", "0.02,1.5,3"],
    );
    // Names with commas.
    expect(
        "Zeit, s;Rate, rad/s;b\n0,02;1,5;3\n",
        &["Zeit s;Rate rad/s;b", "0.02;1.5;3"],
    );
    // A date with its own points, and a time.
    expect(
        "13.02.2024 14:00:00;0,02;1,5\n13.02.2024 14:00:01;0,5;2\n",
        &["13.02.2024 14:00:00;0.02;1.5", "13.02.2024 14:00:01;0.5;2"],
    );
}

#[test]
fn thousands_are_no_decimals() {
    // Either may be meant, and points are decimal marks here.
    for text in [
        "a;b;c\n1,234;5,678;9,012\n",
        "a;b;c\n1,23;0.5;9\n",
        "a,b,c\n1,2,3\n",
        "a,b,c\n\"1,234,567\",2,3\n",
    ] {
        let found = rows(text);
        let same = |rows: &Vec<String>| {
            let numbers = text.lines().last().unwrap();
            rows.last().is_some_and(|row| row.starts_with(numbers))
        };
        assert!(found.as_ref().is_none_or(same), "{text}: {found:?}");
    }
}

#[test]
fn hexadecimal_counts_and_exponents_of_fortran() {
    expect(
        "t,a,b\n1,0x001F,0xFFEB\n2,0xFFFFFFFE,0X10\n",
        &["t,a,b", "1,31,-21", "2,-2,16"],
    );
    expect("1.5D-03 2 -1d2\n", &["1.5e-03 2 -1e2"]);
}

#[test]
fn several_numbers_in_a_cell() {
    expect(
        "t,gyro [rad/s],note\n1,\"[0.1, -0.2, 3e-1]\",a\n2,[4 5 6],b\n",
        &[
            "t,gyro [rad/s],note,gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]",
            "1,\"[0.1, -0.2, 3e-1]\",a,0.1,-0.2,3e-1",
            "2,[4 5 6],b,4,5,6",
        ],
    );
    expect(
        "t,position,h\n1,\"30.44, 114.47\",20\n",
        &[
            "t,position,h,latitude,longitude",
            "1,\"30.44, 114.47\",20,30.44,114.47",
        ],
    );
    expect(
        "t,position,h\n1,\"114.47 30.44\",20\n",
        &[
            "t,position,h,longitude,latitude",
            "1,114.47 30.44,20,114.47,30.44",
        ],
    );
    expect(
        "t,geom,h\n1,POINT (14.47 30.44),20\n",
        &[
            "t,geom,h,longitude,latitude",
            "1,POINT (14.47 30.44),20,14.47,30.44",
        ],
    );
    // Of a row where it is something else the columns are empty.
    expect(
        "t,w,h,i\n1,(1;2;3),20,4\n2,(1;2;3),20,4\n",
        &[
            "t,w,h,i,w_x,w_y,w_z",
            "1,(1;2;3),20,4,1,2,3",
            "2,(1;2;3),20,4,1,2,3",
        ],
    );
}

#[test]
fn latitude_and_longitude_in_a_cell() {
    let expected = "48.125,11.5";
    for (text, between) in [
        ("t;position;alt\n1.5;48.125, 11.5;520\n", ';'),
        ("t,latlon,alt\n1.5,48.125;11.5,520\n", ','),
        ("t,coordinates,alt\n1.5,\"48.125,11.5\",520\n", ','),
    ] {
        let found = rows(text).unwrap_or_else(|| panic!("as usual: {text}"));
        let between = between.to_string();
        let end = format!("{between}{}", expected.replace(',', &between));
        assert!(
            found[0].ends_with(&format!("latitude{between}longitude")),
            "{found:?}"
        );
        assert!(found[1].ends_with(&end), "{found:?}");
    }
    // Thousands.
    let text = "t,range,alt\n1.5,\"1,234.5\",520\n";
    assert!(rows(text).is_none_or(|rows| rows[0] == "t,range,alt"));
}

#[test]
fn angles_in_several_columns() {
    expect(
        "t,lat_deg,lat_min,lat_sec,lon_deg,lon_min,lon_sec\n1,30,26,24.5,-114,28,11\n",
        &[
            "t,lat_deg,lat_min,lat_sec,lon_deg,lon_min,lon_sec",
            "1,30d26m24.5s,26,24.5,-114d28m11s,28,11",
        ],
    );
    expect(
        "t,Lat D,Lat M,Lat S,NS,Lon D,Lon M,Lon S,EW\n1,30,26,24.5,S,114,28,11,W\n",
        &[
            "t,Lat D,Lat M,Lat S,NS,Lon D,Lon M,Lon S,EW",
            "1,30d26m24.5sS,26,24.5,S,114d28m11sW,28,11,W",
        ],
    );
    expect(
        "t,Latitude degrees,Latitude minutes,Longitude degrees,Longitude minutes\n1,-0,26.5,114,28\n",
        &[
            "t,Latitude degrees,Latitude minutes,Longitude degrees,Longitude minutes",
            "1,-0d26.5m,26.5,114d28m,28",
        ],
    );
    for text in ["-0d26.5m", "-0d26m30s"] {
        let (degrees, _) = crate::angle::degrees(text.as_bytes()).unwrap();
        assert!((degrees + 26.5 / 60.0).abs() < 1e-12, "{text}: {degrees}");
    }
    // Degrees with a fraction are the whole angle, and the smallest latitude has no minutes.
    for text in [
        "t,lat_deg,lat_min,lon_deg,lon_min\n1,30.5,26,114.2,28\n",
        "t,lat_deg,lat_min,lon_deg,lon_min\n1,30,-90,114,-180\n",
        "t,lat,lon,h\n1,30,114,20\n",
    ] {
        assert_eq!(rows(text), None, "{text}");
    }
}

#[test]
fn times_in_several_columns() {
    expect(
        "year,month,day,hour,min,sec,gx\n2024,2,13,14,0,0.02,5\n",
        &[
            "year,month,day,hour,min,sec,gx,year + month + day + hour + min + sec",
            "2024,2,13,14,0,0.02,5,2024-02-13T14:00:00.020000",
        ],
    );
    expect(
        "h;m;s;ms;gx\n14;5;9;20;0,5\n",
        &[
            "h;m;s;ms;gx;h + m + s + ms",
            "14;5;9;20;0.5;14:05:09.020000",
        ],
    );
    expect(
        "header.stamp.secs,header.stamp.nsecs,gx\n1707832800,20000000,5\n",
        &[
            "header.stamp.secs,header.stamp.nsecs,gx,header.stamp.secs + header.stamp.nsecs",
            "1707832800,20000000,5,1707832800.020000000",
        ],
    );
}

#[test]
fn dates_and_times_as_one_number() {
    expect(
        "utc,gx,gy\n20240213140000.02,5,6\n",
        &["utc,gx,gy", "2024-02-13T14:00:00.02,5,6"],
    );
    expect(
        "date,utc,gx\n130224,140000.02,5\n",
        &["date,utc,gx", "2024-02-13,14:00:00.02,5"],
    );
    expect(
        "date,utc_time,gx\n20240213,000001.5,5\n",
        &["date,utc_time,gx", "2024-02-13,00:00:01.5,5"],
    );
    // Seconds of the day, and numbers that are no times.
    for text in [
        "utc,gx,gy\n50400.02,5,6\n",
        "utc,gx,gy\n146100.02,5,6\n",
        "t,gx,gy\n140000.02,5,6\n",
        "n,gx,gy\n20241313140000,5,6\n",
    ] {
        assert_eq!(rows(text), None, "{text}");
    }
}

#[test]
fn usual_tables_stay_as_they_are() {
    for text in [
        "",
        "t,gx,gy\n1,2,3\n",
        "t;lat;lon\n2024-02-13 14:00:00;30.5;114.2\n",
        "t lat lon\n1 30.5 114.2\n",
        "# words alone\nno number\n",
        "t,lat,lon\n1,\"48°08'13.5\"\"N\",11°E\n",
        "t,state,a\n1,on (2),3\n2,off,4\n",
        "2025/07/08 19:34:18.499 40.1 -105.1 1601.5\n",
        "t,q,s\n1,2024-02-13 14:00:00.5,3\n",
    ] {
        assert_eq!(rows(text), None, "{text}");
    }
}

#[test]
fn hexadecimal_counts_without_a_mark() {
    expect(
        "00A3 FF12 1E05 0040\n00A4 FF13 1E06 0041\n",
        &["163 -238 7685 64", "164 -237 7686 65"],
    );
    expect(
        "ms,ax,ay,az\n20,ff12,00a3,1e05\n120,ff13,00a4,1e06\n",
        &["ms,ax,ay,az", "20,-238,163,7685", "120,-237,164,7686"],
    );
    expect(
        "2024,0000FF12,FFFFFF12,0001E005\n2024,0000FF13,FFFFFF13,0001E006\n",
        &["2024,65298,-238,122885", "2024,65299,-237,122886"],
    );
    // Numbers as wide as each other, of which no column has letters.
    for text in [
        "2024,1234,0040\n2024,1235,0041\n",
        "1e05,1234,0040\n1e05,1235,0041\n",
        "1e30,1e30,1e30\n1e30,1e30,1e30\n",
        "FE7C,1234,5\nFE7D,1235,6\n",
    ] {
        assert_eq!(rows(text), None, "{text}");
    }
}
