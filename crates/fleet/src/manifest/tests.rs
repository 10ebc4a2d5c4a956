use super::*;
use undrift_noise::BiasModel;

fn jobs(text: &str) -> Result<Vec<Job>, ConfigError> {
    let manifest = Manifest::from_toml(text, "fleet.toml", |_| {})?;
    let found = ["b/drive.toml", "a/drive.toml"].map(str::to_owned);
    manifest.jobs("logs", |_, lookup| match lookup {
        Lookup::Files(pattern) if pattern == "none*" => Ok(Vec::new()),
        Lookup::Files(_) => Ok(found.to_vec()),
        Lookup::Folders(_) => Ok(["SN2/b", "SN1/a"].map(str::to_owned).to_vec()),
        Lookup::Text(text) => Ok(vec![text.replace('|', "\n")]),
    })
}

/// One drive file for several folders of logs: each log has a name of its own.
#[test]
fn a_template_names_its_logs_by_their_folders() {
    let logs = jobs(
        r#"
        unit = "{parent}"
        type = "adis16405"
        labels = { campaign = "winter" }
        [[log]]
        drive = "car.toml"
        data = "SN*/*"
        [[log]]
        drive = "car.toml"
        data = "s3://other/SN3/c/"
        labels = { campaign = "summer", vehicle = "van" }
        outages = { at = "120, 300 s" }
        [[log]]
        drive = "car.toml"
        data = "d"
        name = "the fourth"
        "#,
    )
    .unwrap();
    let names: Vec<_> = logs.iter().map(|job| job.log.as_str()).collect();
    assert_eq!(
        names,
        [
            "SN1/a/car.toml",
            "SN2/b/car.toml",
            "s3://other/SN3/c/car.toml",
            "the fourth"
        ]
    );
    assert!(
        logs.iter()
            .all(|job| job.drive.as_deref() == Some("car.toml"))
    );
    assert!(
        logs.iter()
            .all(|job| job.sensor.as_deref() == Some("adis16405"))
    );
    assert_eq!(logs[0].path(), std::path::Path::new("logs/car.toml"));
    assert_eq!(logs[0].data.as_deref(), Some("SN1/a"));
    assert_eq!(logs[0].unit.as_deref(), Some("SN1"));
    assert_eq!(logs[1].labels["campaign"], "winter");
    assert_eq!(logs[2].labels["campaign"], "summer");
    assert_eq!(logs[2].labels["vehicle"], "van");
    let Task::Outages { plan, .. } = &logs[2].task else {
        panic!()
    };
    assert_eq!(
        plan.schedule(),
        Some(undrift_drive::outages::Schedule::At(vec![120.0, 300.0]))
    );
}

#[test]
fn a_table_has_a_row_for_each_log() {
    let text = |table: &str, more: &str| {
        format!("unit = \"{{folder}}\"\n[[log]]\ntable = '{table}'\n{more}")
    };
    let table =
        "data,unit,type,temperature_c,at,vehicle|SN1/a,,adis,-5.5,90 150 s,van|SN2/b,X7,,,,|";
    let logs = jobs(&text(table, "drive = 'car.toml'\n")).unwrap();
    let [a, b] = logs.as_slice() else { panic!() };
    assert_eq!(
        (a.log.as_str(), b.log.as_str()),
        ("SN1/a/car.toml", "SN2/b/car.toml")
    );
    assert_eq!(
        (a.unit.as_deref(), b.unit.as_deref()),
        (Some("a"), Some("X7"))
    );
    assert_eq!((a.temperature_c, b.temperature_c), (Some(-5.5), None));
    assert_eq!(
        (a.sensor.as_deref(), b.sensor.as_deref()),
        (Some("adis"), None)
    );
    assert_eq!(a.labels["vehicle"], "van");
    assert!(b.labels.is_empty());
    let Task::Outages { plan, .. } = &a.task else {
        panic!()
    };
    assert_eq!(plan.at_s.as_deref(), Some([90.0, 150.0].as_slice()));
    let logs = jobs(&text("drive,record|a.toml,|,b.csv|", "")).unwrap();
    assert_eq!(logs[0].log, "a.toml");
    assert!(matches!(logs[1].task, Task::Identify(_)));
    for (table, more, wanted) in [
        ("unit|SN1|", "", "line 2, drive: missing: a column drive"),
        (
            "drive,at|a,9 1 s|",
            "",
            "line 2, at: \"9 1 s\" must be ascending times",
        ),
        (
            "drive,temperature_c|a,warm|",
            "",
            "line 2, temperature_c: must be a number",
        ),
        ("drive|a,b|", "", "line 2: 2 fields under 1 column names"),
        (
            "drive|a|",
            "drive = '*'\n",
            "line 4, log.drive: beside a table",
        ),
        ("drive|a|", "name = 'n'\n", "line 4, log.name: several logs"),
    ] {
        let error = jobs(&text(table, more)).unwrap_err().to_string();
        assert!(error.contains(wanted), "{table}: {error}");
    }
}

#[test]
fn a_log_has_the_last_word() {
    let jobs = jobs(
        r#"
        model = "adis16405"
        unit = "{folder}"
        bias_models = ["white", "arma"]
        temperature = "298.15 K"
        [outages]
        length = "20 s"
        count = 3
        [[log]]
        drive = "*/drive.toml"
        [[log]]
        drive = "c/drive.toml"
        task = "navigate"
        unit = "SN 7"
        temperature = "-40 degC"
        bias_models = ["ar"]
        [[log]]
        record = "static/SN7.csv.gz"
        unit = "{stem}/{folder}"
        identify = { rate = "100 Hz", gyro_unit = "deg/s", accel_unit = "g", gyro = [2, 3, 4], accel = ["x", "y", "z"] }
        "#,
    )
    .unwrap();
    assert_eq!(
        jobs.iter().map(|j| j.log.as_str()).collect::<Vec<_>>(),
        [
            "a/drive.toml",
            "b/drive.toml",
            "c/drive.toml",
            "static/SN7.csv.gz"
        ]
    );
    let [a, _, c, record] = jobs.as_slice() else {
        panic!()
    };
    assert_eq!(
        (a.unit.as_deref(), a.temperature_c),
        (Some("a"), Some(25.0))
    );
    let Task::Outages {
        bias_models, plan, ..
    } = &a.task
    else {
        panic!("{a:?}")
    };
    assert_eq!(bias_models, &[BiasModel::White, BiasModel::Arma]);
    assert_eq!(
        plan.schedule(),
        Some(undrift_drive::outages::Schedule::Count {
            start: 60.0,
            count: 3
        })
    );
    assert_eq!(plan.length_s, 20.0);
    assert_eq!(
        (c.unit.as_deref(), c.temperature_c),
        (Some("SN 7"), Some(-40.0))
    );
    assert!(
        matches!(&c.task, Task::Navigate { bias_models, .. } if bias_models == &[BiasModel::Ar])
    );
    assert_eq!(record.unit.as_deref(), Some("SN7/static"));
    let Task::Identify(settings) = &record.task else {
        panic!("{record:?}")
    };
    assert_eq!(settings.columns, ["2", "3", "4", "x", "y", "z"]);
    // A job is its JSON.
    for job in &jobs {
        let text = serde_json::to_string(job).unwrap();
        assert_eq!(&serde_json::from_str::<Job>(&text).unwrap(), job);
    }
}

#[test]
fn mistakes_are_reported_with_their_line() {
    for (text, wanted) in [
        ("", "fleet.toml, log: missing"),
        ("[[log]]\n", "fleet.toml line 1, log.drive: set drive"),
        (
            "[[log]]\ndrive='a'\nrecord='b'\n",
            "fleet.toml line 2, log.drive: set drive",
        ),
        (
            "[[log]]\ndrive='a'\ncolour=1\n",
            "fleet.toml line 3, log.colour: unknown key; known here: bias_models, data, drive",
        ),
        (
            "uint='a'\n[[log]]\ndrive='a'\n",
            "fleet.toml line 1, uint: unknown key",
        ),
        (
            "[[log]]\n\ndrive='none*'\n",
            "fleet.toml line 3, log.drive: \"none*\" matches no file",
        ),
        (
            "temperature='warm'\n[[log]]\ndrive='a'\n",
            "fleet.toml line 1, temperature: must be such as",
        ),
        (
            "temperature=25\n[[log]]\ndrive='a'\n",
            "fleet.toml line 1, temperature: must be a string",
        ),
        (
            "log = 3",
            "fleet.toml line 1, log: must be tables: write [[log]]",
        ),
        (
            "log = [3]",
            "fleet.toml line 1, log: must be tables: write [[log]]",
        ),
        (
            "[outages]\nlength=10\n[[log]]\ndrive='a'\n",
            "fleet.toml line 2, outages.length: the number needs a unit",
        ),
        (
            "[outages]\nevery='0 s'\n[[log]]\ndrive='a'\n",
            "fleet.toml line 2, outages.every: must be longer than 0 s",
        ),
        (
            "[[log]]\ndrive='a'\noutages={count=0}\n",
            "fleet.toml line 3, log.outages.count: must be 1 or more",
        ),
        (
            "bias_models=[]\n[[log]]\ndrive='a'\n",
            "must be a list of words",
        ),
        ("[[log]]\ndrive=''\n", "log.drive: the file name is empty"),
    ] {
        let error = jobs(text).unwrap_err().to_string();
        assert!(error.contains(wanted), "{text}: {error}");
    }
}
