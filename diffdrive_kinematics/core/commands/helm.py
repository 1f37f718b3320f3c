# Copyright 2026 diffdrive_kinematics contributors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Who of several viewers drives, how fast, and when that ends: the dead-man's rule."""

from typing import NamedTuple, Tuple

AT_REST = (0.0, 0.0)


class Helm(NamedTuple):
    """
    What the viewer at the helm asks for.

    Nobody else drives until that viewer asks for rest, leaves, or is silent for a timeout; in all
    three cases the robot stands.

    Parameters
    ----------
    timeout_s : float
        Silence [s] after which a motion ends.
    viewer : int
        Who drives; 0: nobody.
    command : pair of float
        Speed v [m/s] and yaw rate omega [rad/s].
    since_s : float
        When it was asked for [s], on a clock that is never set.

    Examples
    --------
    >>> helm = Helm(timeout_s=0.3).asked(viewer=1, command=(0.2, 0.0), now_s=5.0)
    >>> helm.asked(viewer=2, command=(-0.2, 0.0), now_s=5.1).command
    (0.2, 0.0)
    >>> helm.at(5.4).command
    (0.0, 0.0)

    """

    timeout_s: float
    viewer: int = 0
    command: Tuple[float, float] = AT_REST
    since_s: float = 0.0

    def asked(self, viewer: int, command: Tuple[float, float], now_s: float) -> 'Helm':
        """
        Return the helm after a viewer has asked for a command.

        Parameters
        ----------
        viewer : int
            Who asks, not 0.
        command : pair of float
            Speed v [m/s] and yaw rate omega [rad/s]; both 0: rest.
        now_s : float
            When [s], on the same clock as ``since_s``.

        Returns
        -------
        Helm
            The viewer's where it was free or theirs, and left where they ask for rest.

        Examples
        --------
        >>> Helm(timeout_s=0.3).asked(viewer=1, command=(0.2, 0.0), now_s=5.0).viewer
        1

        """
        helm = self.at(now_s)
        if helm.viewer not in (0, viewer):
            return helm
        if command == AT_REST:
            return helm.left(viewer)
        return helm._replace(viewer=viewer, command=command, since_s=now_s)

    def left(self, viewer: int) -> 'Helm':
        """
        Return the helm after a viewer has left it, or the page.

        Parameters
        ----------
        viewer : int
            Who leaves.

        Returns
        -------
        Helm
            Free where it was theirs.

        Examples
        --------
        >>> Helm(timeout_s=0.3, viewer=1, command=(0.2, 0.0)).left(1).command
        (0.0, 0.0)

        """
        return self._replace(viewer=0, command=AT_REST) if viewer == self.viewer else self

    def at(self, now_s: float) -> 'Helm':
        """
        Return the helm at a time: one that is silent is left.

        Parameters
        ----------
        now_s : float
            When [s], on the same clock as ``since_s``.

        Returns
        -------
        Helm
            Free where its viewer was silent for longer than the timeout.

        Examples
        --------
        >>> helm = Helm(timeout_s=0.3, viewer=1, command=(0.2, 0.0), since_s=5.0)
        >>> helm.at(5.2).viewer, helm.at(5.4).viewer
        (1, 0)

        """
        return self.left(self.viewer) if now_s - self.since_s > self.timeout_s else self
