# The commands and the Python module on a CPU. From the root of the project:
#   docker build -f packaging/docker/cpu.Dockerfile -t isoshell . && docker run -v "$PWD:/work" isoshell scan.ply mesh.ply
# vdb_meshinfo is run by --entrypoint vdb_meshinfo.
# scripts/test_packages.sh executes the RUN lines, so one line each.
FROM debian:12 AS build
COPY . /isoshell
WORKDIR /isoshell
RUN apt-get update && scripts/setup.sh packages
RUN scripts/packages.sh

FROM debian:12-slim AS run
COPY --from=build /isoshell/build/packages/*.deb /packages/
RUN apt-get update && apt-get install -y --no-install-recommends /packages/isoshell_*.deb /packages/python3-isoshell_*.deb && rm -rf /var/lib/apt/lists/*
WORKDIR /work
ENTRYPOINT ["vdb_isomesh"]
