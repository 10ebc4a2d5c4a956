use super::*;
use std::{io::Read, net::TcpStream, time::Duration};
use tungstenite::{Error, Message, WebSocket, client, client::IntoClientRequest};
use undrift_nav::{Vector3, earth::Geodetic};

type Client = WebSocket<TcpStream>;

fn connect(address: SocketAddr, protocol: &str) -> Result<Client, String> {
    let stream = TcpStream::connect(address).unwrap();
    let wait = Some(Duration::from_secs(30));
    stream.set_read_timeout(wait).unwrap();
    let mut request = format!("ws://{address}/").into_client_request().unwrap();
    let headers = request.headers_mut();
    headers.insert("Sec-WebSocket-Protocol", protocol.parse().unwrap());
    let (socket, response) = client(request, stream).map_err(|error| error.to_string())?;
    let chosen = &response.headers()["Sec-WebSocket-Protocol"];
    assert!(protocol.ends_with(chosen.to_str().unwrap()));
    Ok(socket)
}

fn text(socket: &mut Client) -> Value {
    let message = socket.read().unwrap();
    serde_json::from_str(message.to_text().unwrap()).unwrap()
}

/// A message of a channel: number of the subscription, time [ns], content.
fn data(socket: &mut Client) -> (u32, u64, Value) {
    let bytes = socket.read().unwrap().into_data();
    assert_eq!(bytes[0], 1);
    let id = u32::from_le_bytes(bytes[1..5].try_into().unwrap());
    let time = u64::from_le_bytes(bytes[5..13].try_into().unwrap());
    (id, time, serde_json::from_slice(&bytes[13..]).unwrap())
}

fn row(time: f64) -> SolutionRow {
    SolutionRow {
        v_n: Vector3::new(3.0, 4.0, 0.5),
        rpy: Vector3::new(0.0, 0.0, 1.0),
        nav_std: [1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0.01, 0.02, 0.03],
        ..SolutionRow::at(time, Geodetic::from_degrees(40.5, -105.25, 1600.0))
    }
}

#[test]
fn a_client_gets_what_it_subscribes_to() {
    let mut foxglove = Foxglove::serve("127.0.0.1:0", 0.1).unwrap();
    foxglove.notice(None, "before anybody listened", true);
    let mut socket = connect(foxglove.address(), "foxglove.sdk.v9, foxglove.websocket.v1").unwrap();
    assert_eq!(text(&mut socket)["op"], "serverInfo");
    let channels = text(&mut socket)["channels"].clone();
    assert_eq!(channels.as_array().unwrap().len(), 4);
    for channel in channels.as_array().unwrap() {
        assert_eq!(channel["encoding"], "json");
        let schema: Value = serde_json::from_str(channel["schema"].as_str().unwrap()).unwrap();
        assert_eq!(schema["type"], "object", "{channel}");
    }
    assert_eq!(channels[2]["schemaName"], "undrift.State");
    let subscriptions = [(70, 0), (71, 1), (72, 2), (73, 3)];
    let subscriptions = subscriptions.map(|(id, of)| json!({ "id": id, "channelId": of }));
    let subscribe = json!({ "op": "subscribe", "subscriptions": subscriptions });
    socket.send(Message::text(subscribe.to_string())).unwrap();
    let (id, _, log) = data(&mut socket);
    assert_eq!((id, &log["level"]), (73, &json!(3)));
    assert_eq!(log["message"], "before anybody listened");

    foxglove.row(&row(1.5), None);
    // Too soon.
    foxglove.row(&row(1.55), None);
    foxglove.row(&row(1.75), Some(0.25));
    let (id, time, fix) = data(&mut socket);
    assert_eq!((id, time), (70, 1_500_000_000));
    assert_eq!(fix["timestamp"], json!({ "sec": 1, "nsec": 500_000_000 }));
    assert_eq!(fix["longitude"], -105.25);
    assert_eq!(
        fix["position_covariance"],
        json!([4.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 9.0])
    );
    assert_eq!(fix["velocity"], json!({ "x": 4.0, "y": 3.0, "z": -0.5 }));
    let (id, _, pose) = data(&mut socket);
    assert_eq!((id, &pose["pose"]["position"]["x"]), (71, &json!(0.0)));
    // Yaw 1 rad from north to the east is π/2 − 1 from east to the north.
    let half = (std::f64::consts::FRAC_PI_2 - 1.0) / 2.0;
    let z = pose["pose"]["orientation"]["z"].as_f64().unwrap();
    assert!((z.abs() - half.sin()).abs() < 1e-12, "{pose}");
    let (id, _, state) = data(&mut socket);
    assert_eq!((id, &state["without_gnss"]), (72, &json!(true)));
    assert_eq!(state["gyro_bias_x_dps"], Value::Null);
    let (_, time, _) = data(&mut socket);
    assert_eq!(time, 1_750_000_000);
    data(&mut socket);
    assert_eq!(data(&mut socket).2["since_fix_s"], 0.25);

    let leave = json!({ "op": "unsubscribe", "subscriptionIds": [70, 71, 72] });
    socket.send(Message::text(leave.to_string())).unwrap();
    // What it says is heard after the rows that wait: until it is, rows come.
    let mut k = 20.0;
    loop {
        foxglove.row(&row(k), None);
        foxglove.notice(Some(k), "row", false);
        let first = data(&mut socket).0;
        if first == 73 {
            break;
        }
        while data(&mut socket).0 != 73 {}
        k += 1.0;
        assert!(k < 1000.0, "still subscribed");
    }
    assert_eq!(foxglove.dropped(), 0);
}

#[test]
fn other_clients_are_refused_and_a_sleeper_delays_nobody() {
    let mut foxglove = Foxglove::serve("127.0.0.1:0", 0.0).unwrap();
    let refused = connect(foxglove.address(), "chat").unwrap_err();
    assert!(refused.contains("400"), "{refused}");
    let mut stream = TcpStream::connect(foxglove.address()).unwrap();
    std::io::Write::write_all(&mut stream, b"\x00\x01not http\r\n\r\n").unwrap();
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);

    let mut sleeper = connect(foxglove.address(), "foxglove.sdk.v1").unwrap();
    let subscribe = json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 2 }] });
    sleeper.send(Message::text(subscribe.to_string())).unwrap();
    let begin = std::time::Instant::now();
    for k in 0..30_000 {
        foxglove.row(&row(0.01 * f64::from(k)), Some(0.5));
    }
    assert!(begin.elapsed() < Duration::from_secs(60));
    assert!(foxglove.dropped() > 0, "the sleeper's");
    // Too long a message ends the connection.
    let mut flood = connect(foxglove.address(), "foxglove.sdk.v1").unwrap();
    let _ = flood.send(Message::text("x".repeat(1 << 20)));
    let ended = (0..10_000).find_map(|_| flood.read().err());
    assert!(matches!(
        ended,
        Some(Error::ConnectionClosed | Error::Protocol(_) | Error::Io(_))
    ));
}
