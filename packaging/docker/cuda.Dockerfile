# The commands and the Python module on a CUDA device. From the root of the project:
#   docker build -f packaging/docker/cuda.Dockerfile -t isoshell-cuda .
#   docker run --gpus all -v "$PWD:/work" isoshell-cuda scan.ply mesh.ply
# scripts/test_packages.sh executes the RUN lines of the stage run, with packages without CUDA: NVIDIA's images and the
# stage build, which needs nvcc, are not tested.
FROM nvidia/cuda:12.9.1-devel-ubuntu24.04 AS build
COPY . /isoshell
WORKDIR /isoshell
RUN apt-get update && scripts/setup.sh packages
RUN ISOSHELL_CUDA=on scripts/packages.sh

FROM nvidia/cuda:12.9.1-base-ubuntu24.04 AS run
COPY --from=build /isoshell/build/packages/*.deb /packages/
RUN apt-get update && apt-get install -y --no-install-recommends /packages/isoshell_*.deb /packages/python3-isoshell_*.deb && rm -rf /var/lib/apt/lists/*
WORKDIR /work
ENTRYPOINT ["vdb_isomesh"]
