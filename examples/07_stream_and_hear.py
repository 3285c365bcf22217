"""One end streams a face over VMC, the other hears it and lets a character act, frame by frame.

python examples/07_stream_and_hear.py
"""

import socket

import numpy as np

import mien
from mien.formats.streams import vmc
from mien.live.stage import Stage
from mien.performance.arkit_frame import ArkitFrame
from mien.vocabulary.arkit import names

JAW = np.array([name == "jawOpen" for name in names()], dtype=float)


def main() -> None:
    """Thirty frames over the loopback; print what the toy does with the last."""
    hearing, sending = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    with hearing, sending:
        hearing.bind(("127.0.0.1", 0))
        hearing.settimeout(5.0)
        stage, decoder = Stage([mien.load_character("toy")]), vmc.Decoder()
        for i in range(30):
            heard = []
            for datagram in vmc.encode(ArkitFrame(i / 30, JAW * i / 30)):
                sending.sendto(datagram, hearing.getsockname())
                heard += decoder.decode(hearing.recv(vmc.LARGEST_DATAGRAM), i / 30)
            moment = stage.hear(heard[-1])
    curves = moment.curves["toy"]
    strongest = int(curves.weights[0].argmax())
    print(
        f"after {moment.time:.2f} s: {curves.names[strongest]} {curves.weights[0, strongest]:.2f}"
    )


if __name__ == "__main__":
    main()
