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

"""The examples in the docstrings of the models and of the commands do what they show."""

import doctest
from importlib import import_module
import inspect
from pathlib import Path

import pytest

CORE = Path(__file__).resolve().parents[2] / 'diffdrive_kinematics' / 'core'
NAMES = [
    f'diffdrive_kinematics.core.{room}.{path.stem}'
    for room in ('models', 'commands') for path in sorted((CORE / room).glob('[a-z]*.py'))]


@pytest.mark.parametrize('name', NAMES)
def test_the_examples_of_a_module_run(name):
    assert doctest.testmod(import_module(name)).failed == 0


@pytest.mark.parametrize('name', NAMES)
def test_every_public_function_has_an_example(name):
    module = import_module(name)
    functions = [each for each in map(vars(module).get, module.__all__)
                 if inspect.isfunction(each)]
    assert all('>>> ' in each.__doc__ for each in functions)
