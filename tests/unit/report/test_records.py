import json

import numpy as np
import pytest

from regframe.geometry import AffineMap
from regframe.report.records import result_record, to_json, trace_rows, transform_record
from regframe.transforms.affine import from_factors
from regframe.transforms.linear import turn
from support.results import STEPS, image, ramp, result


def test_pixel_matrices_both_ways_are_inverse():
    record = transform_record(result())

    product = np.array(record["fixed_to_moving_px"]) @ record["moving_to_fixed_px"]

    assert np.allclose(product, np.eye(3), atol=1e-12)


def test_pixel_matrix_follows_spacing_and_physical_matrix_does_not():
    fixed = image(ramp((12, 16)), "fixed.mha", spacing=(2.0, 2.0))
    moving = image(ramp((12, 16)), "moving.mha", spacing=(1.0, 1.0))

    record = transform_record(result(fixed, moving, shift=(5, 0)))

    assert np.allclose(record["fixed_to_moving_px"], [[2, 0, 5], [0, 2, 0], [0, 0, 1]])
    assert np.allclose(record["fixed_to_moving_physical"], [[1, 0, 5], [0, 1, 0], [0, 0, 1]])


def test_parameters_are_named():
    (warp,) = transform_record(result())["warps"]

    assert warp["type"] == "similarity"
    assert warp["parameters"] == {"scale": 1.1, "angle_rad": 0.05, "tx": 2.0, "ty": -1.0}
    assert warp["centre"] == [7.5, 5.5]


def test_factors_make_the_same_map():
    made = result()
    record = transform_record(made)
    params = from_factors(record["factors"])

    assert np.allclose(params[:4].reshape(2, 2), 1.1 * turn(0.05))
    assert np.allclose(params[4:], [2.0, -1.0])


def test_chains_list_their_members():
    made = result()
    chained = transform_record(type(made)(**{**vars(made), "warp": made.warp @ made.warp}))

    assert [one["type"] for one in chained["warps"]] == ["similarity", "similarity"]
    twice = made.pixel_map @ made.pixel_map
    assert np.allclose(chained["fixed_to_moving_px"], twice.homogeneous())


def test_the_convention_is_written_out_in_words():
    convention = transform_record(result())["convention"]

    assert {"direction", "pixels", "matrices", "parameters"} <= set(convention)
    assert all(words.endswith(".") for words in convention.values())


def test_three_dimensions_have_matrices_and_no_plane_factors():
    one = image(ramp((6, 8, 10), np.float32), "volume")

    record = transform_record(result(one, one, shift=(1, 2, 3)))

    assert "factors" not in record
    assert np.allclose(record["fixed_to_moving_px"], AffineMap(np.eye(3), np.array([1, 2, 3])).homogeneous())


def test_the_result_holds_preset_provenance_and_levels():
    record = result_record(result())

    assert record["preset"]["name"] == "paper-similarity"
    assert record["provenance"]["seed"] == 1
    assert record["stop"] == "the limit of 5 iterations"
    assert [level["parameters"]["scale"] for level in record["levels"]] == [1.1, 1.1]
    assert record["evaluations"] == 12


def test_the_trace_has_a_line_an_iteration_and_a_column_a_parameter():
    head, *rows = trace_rows(result())

    assert head == [
        *("stage", "level", "iteration", "evaluations", "value", "size"),
        *("scale", "angle_rad", "tx", "ty", "seconds"),
    ]
    assert len(rows) == 2 * STEPS
    assert rows[STEPS][:4] == ["0", "1", "0", "2"]


def test_numbers_of_the_trace_lose_no_bit():
    made = result()
    head, first, *_ = trace_rows(made)

    assert float(first[head.index("value")]) == made.trace[0].value
    assert float(first[head.index("angle_rad")]) == made.trace[0].params[1]


@pytest.mark.parametrize("number", [float("inf"), float("-inf"), float("nan")])
def test_json_has_no_infinite_numbers(number):
    assert json.loads(to_json({"a": [1.5, {"b": number}]})) == {"a": [1.5, {"b": None}]}


def test_rows_of_matrices_stay_on_one_line():
    assert "[1.0, 0.0]" in to_json({"matrix": [[1.0, 0.0], [0.0, 1.0]]})


def test_json_reads_back_what_was_written():
    record = transform_record(result())

    assert json.loads(to_json(record)) == json.loads(json.dumps(record))
