"""Wallace's generator: golden values, pass borders, seeds, the slow twin."""

import numpy as np
import pytest

from naive.variates import Variates
from regframe.kernels.variates import Wallace

# Read from SimpleITK 2.5.7 through the positions its optimizer visits.
FIRST_20 = {
    1: """0.35044095471380032 -1.4561010221392412 -0.67447167675908426 0.43430267757726515 -1.3775900892225541
    1.3692330115228333 -0.14692638494492549 1.0923757124005187 1.903051491915603 -0.43459601468966491
    0.9410326630737853 1.3787850899146208 1.6297027405065245 1.4138973621064963 -1.2073660551666043
    0.21108643430038387 0.74306306554116963 0.29493158222483423 -0.22858167551168168 -0.39146713894059049""",
    42: """0.27288016448409647 -0.88183392859441811 1.4728334089083195 0.19045908698286038
    -0.37934195866718018
    -0.39239932829301638 -0.73285372346331823 -0.060405629405931111 -1.8671672664829775 -0.49401842299651638
    0.3386667491166297 0.0027154758830657127 -0.58141953514151079 0.44122286202598354 1.0589952767152881
    -1.6010490603978043 -0.42117712717342787 1.2910898403359168 0.069107479697668492 1.3919035296992301""",
    121212: """-1.3591735962224838 0.98096956524379508 -0.43378837731950837 1.0007640025473947
    -0.063467868864761162 -0.14956503343014582 -0.33224334832416869 -0.76784096844822947
    0.74965549855625824 0.47164712453399599 -1.7488949212541092 -1.1150100393791129 0.068302065898726713
    -0.097868284468127856 -0.027371644582536228 1.2907590577852144 0.23253604500797098 2.3176482227014379
    1.061589894134443 -1.6254136024707466""",
}
BORDERS = {  # 1-based places 1022, 1023 (the last of the first pass), 1024, 1025, 2046, 2047
    1: """1.5620090517317331 0.59884396431099784 0.56734977872682424 -0.87640796100844265
    -0.1758712328412734 -0.64484556095695145""",
    42: """-0.032618638337341833 -1.5687458024553347 -0.5790536888976543 -0.29053478156702917
    0.18666008422409994 1.3640938243364533""",
    121212: """-0.16768359011964681 1.5524584163461268 -0.50407826913976017 -0.85475125412075581
    0.94515559085344891 0.59672659466254929""",
}
SUMS = {1: 6.0118433914847653, 42: -1.4736770719013577, 121212: -10.755356533276597}


def numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


@pytest.mark.parametrize("seed", FIRST_20)
def test_begins_with_the_golden_values(seed):
    drawn = Wallace(seed).standard_normal(20)

    assert drawn.tolist() == numbers(FIRST_20[seed])


@pytest.mark.parametrize("seed", BORDERS)
def test_crosses_pass_borders_with_the_golden_values(seed):
    drawn = Wallace(seed).standard_normal(2047)

    assert drawn[[1021, 1022, 1023, 1024, 2045, 2046]].tolist() == numbers(BORDERS[seed])
    assert np.cumsum(drawn[:1023])[-1] == pytest.approx(SUMS[seed], rel=1e-13)  # the order of the sum is free


def test_measures_its_pool_anew_after_256_passes():
    drawn = Wallace(42).standard_normal(300000)

    assert drawn[-1] == 2.1665823585540682


@pytest.mark.parametrize(
    ("seed", "expected"),
    [
        (4294967295, [0.56959115965731033, -1.3788488309948412]),
        (-1, [0.56959115965731033, -1.3788488309948412]),
        (2147483648, [-0.58057605135612544, -0.6876607098096964]),
    ],
)
def test_seeds_are_signed_words(seed, expected):
    assert Wallace(seed).standard_normal(2).tolist() == expected


def test_seed_zero_is_a_seed_like_any_other():
    first, again = Wallace(0).standard_normal(5), Wallace(0).standard_normal(5)

    assert first.tolist() == again.tolist()


def test_has_the_golden_state_after_the_first_draw():
    generator = Wallace(42)

    generator.standard_normal(1)

    assert generator._pool[:4].tolist() == [8345253, -47975567, -997547, 40501780]
    assert generator._pool[1023] == -25507477
    assert generator._gain == 3.2698848612989497e-08
    assert generator._inverse == pytest.approx(1.0000000133683244, rel=1e-16)


def test_fills_its_pool_with_the_golden_integers():
    generator = Wallace(42)

    generator._refill()

    assert generator._pool[:6].tolist() == [12217, 3334392, -24989663, 19609463, 18314331, 24756036]
    assert generator._pool[1021:].tolist() == [-34683827, -23636789, 57239768]
    assert generator._congruential == 1822316256
    assert generator._register == -1573801055 % 2**32


@pytest.mark.parametrize("seed", [0, 7, 2**31 - 1, 2**31, 3_000_000_000])
def test_equals_its_slow_twin(seed):
    twin = Variates(seed)

    drawn = Wallace(seed).standard_normal(6000)

    assert drawn.tolist() == [twin.draw() for _ in range(6000)]


def test_the_stream_does_not_depend_on_how_it_is_asked_for():
    whole, parts = Wallace(5), Wallace(5)

    drawn = np.concatenate([parts.standard_normal(size) for size in (0, 1, 4, 1018, 1, 2000, 76)])

    assert drawn.tolist() == whole.standard_normal(3100).tolist()


def test_deviates_are_standard_normal():
    drawn = Wallace(3).standard_normal(200_000)

    # 5 standard errors of the mean, of the variance and of the share within one deviation
    assert abs(drawn.mean()) < 5 / np.sqrt(200_000)
    assert abs(drawn.var() - 1.0) < 5 * np.sqrt(2 / 200_000)
    assert abs((np.abs(drawn) < 1).mean() - 0.682689) < 5 * np.sqrt(0.6827 * 0.3173 / 200_000)
