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

"""How Sphinx and rosdoc2 make the documentation: `sphinx-build -W docs build/docs`."""

from pathlib import Path
import sys

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

project = 'diffdrive_kinematics'
copyright = '2026, diffdrive_kinematics contributors'  # noqa: A001
extensions = ['myst_parser', 'numpydoc', 'sphinx.ext.autodoc', 'sphinx.ext.mathjax']
exclude_patterns = ['_build', '*.rst', 'standard_docs']  # rosdoc2 adds a page for each file
myst_enable_extensions = ['colon_fence']
myst_heading_anchors = 3
numpydoc_show_class_members = False
autodoc_member_order = 'bysource'
autodoc_typehints = 'none'  # numpydoc says them, with units
highlight_language = 'text'
html_theme = 'alabaster'
html_theme_options = {'page_width': '1200px', 'sidebar_width': '290px'}
