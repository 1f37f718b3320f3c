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

"""
Wheel motion as a robot answers it: other rates than were commanded, a delay later.

What was commanded from a stamp on is done from the stamp plus the delay on, whenever the
messages come: the result depends on stamps only.  A robot of which nothing is due yet rests.
"""

from dataclasses import replace
from typing import Callable, List, NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry.timeouts import ClockStep, STEP_TOLERANCE_NS
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, WheelSample, ZERO


class AnsweredMotion(NamedTuple):
    """
    What was commanded and is not done yet.

    Parameters
    ----------
    answer : callable
        Gives the rates (left, right) [rad/s] that are driven for those that were commanded.
    delay_ns : int
        How late they are driven [ns].
    waiting : tuple of WheelSample
        What is to be done later, in order of time.
    last : WheelSample or None
        The last command.
    since_ns : int
        From when on [ns] its rates were commanded; what came after it repeats them.

    Examples
    --------
    A robot that turns half as fast as commanded, 0.3 s later:

    >>> motion = AnsweredMotion(lambda rates: (0.5 * rates[0], 0.5 * rates[1]), 300_000_000)
    >>> motion, due = motion.update(WheelSample(0, (2.0, 2.0)))
    >>> [(sample.stamp_ns, sample.rates) for sample in due]
    [(0, (0.0, 0.0))]
    >>> motion, due = motion.update(WheelSample(500_000_000, (0.0, 0.0)))
    >>> [(sample.stamp_ns, sample.rates) for sample in due]
    [(300000000, (1.0, 1.0))]

    """

    answer: Callable[[WheelPair], WheelPair]
    delay_ns: int
    waiting: Tuple[WheelSample, ...] = ()
    last: Optional[WheelSample] = None
    since_ns: int = 0

    def update(self, sample: WheelSample) -> Tuple['AnsweredMotion', List[WheelSample]]:
        """
        Return the state after a message, and what is done up to its stamp.

        Parameters
        ----------
        sample : WheelSample
            What is commanded; of positions alone the rates since the message before count.

        Returns
        -------
        motion : AnsweredMotion
            The state.
        due : list of WheelSample
            What is done, in order of time.  A command that is stamped among the repeats of the
            last one takes the place of those after it, and one of before is dropped, as bases do;
            where it is of more than a second before the rates changed last, all that waited is.

        Examples
        --------
        See :class:`AnsweredMotion`.

        """
        now_ns, last = sample.stamp_ns, self.last
        waiting, since_ns = self.waiting, self.since_ns
        if last is not None and now_ns < last.stamp_ns:
            if since_ns - STEP_TOLERANCE_NS > now_ns:
                waiting, last = (), None
            elif sample.rates in (None, last.rates) or now_ns <= since_ns:
                return self, []
            else:
                waiting = tuple(
                    each for each in waiting if each.stamp_ns < now_ns + self.delay_ns)
        if last is None or sample.rates != last.rates:
            since_ns = now_ns
        commanded = self._commanded(sample, last)
        if commanded is not None:
            waiting = (*waiting, WheelSample(
                commanded[0] + self.delay_ns, self.answer(commanded[1]), source=sample.source))
        due = [each for each in waiting if each.stamp_ns <= now_ns]
        later = tuple(each for each in waiting if each.stamp_ns > now_ns)
        if last is None and not due:
            due = [WheelSample(now_ns, ZERO, source=sample.source)]
        return self._replace(waiting=later, last=sample, since_ns=since_ns), due

    def clock_stepped(self, step: ClockStep) -> 'AnsweredMotion':
        """
        Return the state as it reads after the clock of the stamps was stepped.

        Parameters
        ----------
        step : ClockStep
            By how much, and when.

        Returns
        -------
        AnsweredMotion
            The state with its times moved, where they are of before: what waits is done as late
            as it would have been.

        Examples
        --------
        >>> motion, _ = AnsweredMotion(lambda rates: rates, 300).update(WheelSample(0, (2.0, 2.0)))
        >>> [sample.stamp_ns for sample in motion.clock_stepped(ClockStep(-100, -90)).waiting]
        [200]

        """
        if self.last is None or not step.is_after(self.last.stamp_ns, STEP_TOLERANCE_NS):
            return self
        return self._replace(
            waiting=tuple(_moved(each, step.step_ns) for each in self.waiting),
            last=_moved(self.last, step.step_ns), since_ns=self.since_ns + step.step_ns)

    def configured(self, new: 'AnsweredMotion') -> 'AnsweredMotion':
        """
        Return the state under another answer and delay.

        Parameters
        ----------
        new : AnsweredMotion
            The answer and delay, which nothing was commanded yet.

        Returns
        -------
        AnsweredMotion
            What waits moves by the change of the delay, but not before what was done already.

        Examples
        --------
        >>> motion = AnsweredMotion(lambda rates: rates, 300_000_000)
        >>> motion, _ = motion.update(WheelSample(0, (2.0, 2.0)))
        >>> motion = motion.configured(AnsweredMotion(lambda rates: rates, 200_000_000))
        >>> [sample.stamp_ns for sample in motion.waiting]
        [200000000]

        """
        if self.last is None:
            return new
        shift, first = new.delay_ns - self.delay_ns, self.last.stamp_ns + 1
        moved = [_moved(each, shift) for each in self.waiting]
        over = [replace(each, stamp_ns=first) for each in moved if each.stamp_ns <= first]
        later = [each for each in moved if each.stamp_ns > first]
        return new._replace(
            waiting=(*over[-1:], *later), last=self.last, since_ns=self.since_ns)

    @staticmethod
    def _commanded(
            sample: WheelSample, last: Optional[WheelSample]) -> Optional[Tuple[int, WheelPair]]:
        """Return from when on which rates are commanded; None where that is not known."""
        if sample.rates is not None:
            return sample.stamp_ns, sample.rates
        if last is None or last.positions is None or sample.positions is None:
            return None
        seconds = (sample.stamp_ns - last.stamp_ns) / NANOSECONDS
        if seconds <= 0.0:
            return None
        return last.stamp_ns, ((sample.positions[0] - last.positions[0]) / seconds,
                               (sample.positions[1] - last.positions[1]) / seconds)


def _moved(sample: WheelSample, by_ns: int) -> WheelSample:
    return replace(sample, stamp_ns=sample.stamp_ns + by_ns)
