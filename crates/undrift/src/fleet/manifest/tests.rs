use super::*;
use undrift_noise::BiasModel;

fn jobs(text: &str) -> Result<Vec<Job>, ConfigError> {
    let manifest = Manifest::from_toml(text, "fleet.toml", |_| {})?;
    let found = ["b/drive.toml", "a/drive.toml"].map(str::to_owned);
    manifest.jobs("logs", |_, pattern| match pattern {
        "none*" => Ok(Vec::new()),
        _ => Ok(found.to_vec()),
    })
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
        Some(crate::outages::Schedule::Count {
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
fn mistakes_are_told_with_their_line() {
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
            "fleet.toml line 3, outages.count: must be 1 or more",
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
