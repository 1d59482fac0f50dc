"""Figures: what they show, and that nothing in them overlaps."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scene_files import DAHNEKE, edited, written

from pyjkr import compare, plot
from pyjkr.plan import plan
from pyjkr.scene import load


@pytest.fixture(scope="module")
def comparison(tmp_path_factory):
    text = edited(DAHNEKE, ("[1.0, 0.1]", "[1.0, 0.1, 0.03]"))
    made = plan(load(written(tmp_path_factory.mktemp("scene"), text)))
    return compare.compare(made, compare.oracle_outcomes(made), None)


@pytest.fixture(scope="module")
def curves(comparison):
    return compare.oracle_curves(comparison.plan)


def boxes(figure):
    figure.draw_without_rendering()
    return [axes.get_tightbbox() for axes in figure.axes], [legend.get_window_extent() for legend in figure.legends]


def labels_of(axes):
    return [label.get_window_extent() for label in axes.get_xticklabels() if label.get_text()]


def test_every_case_is_a_point_of_the_restitution_figure(comparison, curves):
    (axes,) = plot.restitution_figure(comparison, curves).axes
    markers = [line for line in axes.lines if line.get_marker() not in ("None", None)]
    shown = {(x, y) for line in markers for x, y in zip(*line.get_data(), strict=True)}
    assert shown == set(zip(comparison.table["speed"], comparison.table["e_eff_oracle"], strict=True))
    assert sum(len(line.get_xdata()) for line in markers) == len(comparison.table)


def test_points_that_coincide_differ_in_shape_size_and_colour(comparison, curves):
    (axes,) = plot.restitution_figure(comparison, curves).axes
    markers = [line for line in axes.lines if line.get_marker() not in ("None", None)]
    for first, second in itertools.combinations(markers, 2):
        assert first.get_marker() != second.get_marker()
        assert first.get_markersize() != second.get_markersize()
        assert first.get_color() != second.get_color()


def test_legends_lie_outside_the_axes_and_tick_labels_apart(comparison, curves):
    for figure in (plot.restitution_figure(comparison, curves), plot.velocity_figure(comparison)):
        axes_boxes, legend_boxes = boxes(figure)
        assert legend_boxes
        assert not any(legend.overlaps(box) for legend in legend_boxes for box in axes_boxes)
        assert all(figure.bbox.padded(1).contains(*corner) for legend in legend_boxes for corner in legend.corners()[[0, 3]])
        for axes in figure.axes:
            labels = labels_of(axes)
            assert not any(first.overlaps(second) for first, second in itertools.combinations(labels, 2))


def test_axes_carry_units(comparison, curves):
    (axes,) = plot.restitution_figure(comparison, curves).axes
    left, right = plot.velocity_figure(comparison).axes
    assert "[m/s]" in axes.get_xlabel()
    assert "[ns]" in left.get_xlabel()
    assert "[ns]" in right.get_xlabel()
    assert "[m/s]" in left.get_ylabel()


def test_velocities_over_scaled_time_fall_on_one_curve(comparison):
    left, right = plot.velocity_figure(comparison).axes
    lines = [line for line in right.lines if len(line.get_xdata()) > 2]
    assert len(lines) == 3
    for line in lines[1:]:
        # Interpolation between 400 samples of a curve of a few m/s.
        assert np.interp(lines[0].get_xdata(), *line.get_data()) == pytest.approx(lines[0].get_ydata(), abs=1e-3)
    unscaled = [line for line in left.lines if len(line.get_xdata()) > 2]
    assert unscaled[2].get_xdata()[-1] / unscaled[0].get_xdata()[-1] == pytest.approx(0.03**-0.4, rel=1e-6)


def test_figures_are_written_as_png(tmp_path, comparison):
    plot.save(plot.velocity_figure(comparison), tmp_path / "velocity.png")
    assert (tmp_path / "velocity.png").read_bytes().startswith(b"\x89PNG")
