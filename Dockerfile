# The command in an image of its own: docker build -t undrift . && docker run --rm -v "$PWD:/logs" undrift inspect imu.csv
FROM rust:1.95-slim AS build
RUN apt-get update -q && apt-get install -qy --no-install-recommends gcc libc6-dev && rm -rf /var/lib/apt/lists/*
WORKDIR /undrift
COPY . .
RUN cargo build --profile dist --locked --package undrift-cli

FROM debian:trixie-slim
COPY --from=build /undrift/target/dist/undrift /usr/local/bin/undrift
WORKDIR /logs
USER 1000
ENTRYPOINT ["undrift"]
