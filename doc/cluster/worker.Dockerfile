# docker build --file doc/cluster/worker.Dockerfile --tag REGISTRY/vista-worker .    (in a checkout)
FROM debian:12 AS build
RUN apt-get update && apt-get install --yes --no-install-recommends gcc g++ make git python3 python3-venv python3-dev
COPY . /vista
WORKDIR /vista
RUN python3 -m venv /tools && /tools/bin/pip install --require-hashes --requirement scripts/requirements/build.txt \
    && /tools/bin/pip wheel --no-deps --no-build-isolation --wheel-dir /wheels . sw/eval

FROM debian:12
RUN apt-get update && apt-get install --yes --no-install-recommends python3 python3-venv && rm -rf /var/lib/apt/lists/*
COPY --from=build /wheels /wheels
COPY scripts/requirements/run.txt scripts/requirements/jobs.txt /
RUN python3 -m venv /vista && /vista/bin/pip install --no-cache-dir --require-hashes -r /run.txt -r /jobs.txt \
    && /vista/bin/pip install --no-cache-dir --no-deps /wheels/*.whl && /vista/bin/pip install --no-cache-dir s3fs
ENV PATH=/vista/bin:$PATH OMP_NUM_THREADS=1
