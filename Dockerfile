# SPDX-License-Identifier: GPL-3.0-or-later
# dd3imp on Debian 12: the program, its utilities, examples and documents in /usr/local, the work in /work.
#
#   docker build --tag dd3imp .
#   docker run --rm --volume "$PWD:/work" dd3imp dd3imp job.dat
#   docker run --rm --volume "$PWD:/work" dd3imp dd3 report job.out
FROM debian:12

WORKDIR /usr/local/src/dd3imp
COPY . .
RUN utils/install_needed.sh --no-python \
  && cmake --preset release -DBUILD_TESTING=OFF \
  && cmake --build --preset release \
  && cmake --install build/release --prefix /usr/local \
  && /usr/local/share/dd3imp/utils/install_needed.sh \
  && rm -rf /usr/local/src/dd3imp /var/lib/apt/lists/* /root/.cache

ENV OMP_WAIT_POLICY=passive LD_LIBRARY_PATH=/usr/local/lib
WORKDIR /work
CMD ["dd3imp", "--help"]
