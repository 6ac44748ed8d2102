# SPDX-License-Identifier: GPL-3.0-or-later
# dd3imp on Debian 12: the wheel is built in a stage of its own; the image has it in /opt/dd3, the work is in /work.
#
#   docker build --tag dd3imp .                            with --build-arg EXTRAS=plot: without CAD
#   docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD:/work" dd3imp dd3imp job.dat
#   docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD:/work" dd3imp dd3 report job.out
FROM debian:12 AS build
WORKDIR /usr/local/src/dd3imp
COPY . .
RUN utils/install_needed.sh --no-python && utils/packaging/wheel.sh

FROM debian:12-slim
ARG EXTRAS=all
RUN --mount=type=bind,from=build,source=/usr/local/src/dd3imp/dist,target=/dist \
  apt-get update -q \
  && apt-get install -y -q --no-install-recommends python3-venv libegl1 libgl1 libgl1-mesa-dri libglu1-mesa libgomp1 \
    libxcursor1 libxft2 libxinerama1 libxrender1 \
  && python3 -m venv /opt/dd3 \
  && /opt/dd3/bin/pip install --no-cache-dir "$(echo /dist/*.whl)[$EXTRAS]" \
  && find /opt/dd3/lib -path "*/pandas/*" -name tests -prune -exec rm -r {} + \
  && find /opt/dd3/lib -path "*/scipy/*" -name tests -prune -exec rm -r {} + \
  && apt-get clean && rm -rf /var/lib/apt/lists/* \
  && useradd --create-home dd3 && install --directory --owner dd3 --group dd3 /work

ENV PATH=/opt/dd3/bin:$PATH OMP_WAIT_POLICY=passive MPLCONFIGDIR=/tmp
USER dd3
WORKDIR /work
CMD ["dd3imp", "--help"]
