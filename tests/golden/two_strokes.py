# title: two strokes
import sys

from xarm.wrapper import XArmAPI

UPRIGHT = (180.0000, 0.0000, 0.0000)
TOOL = [0.000, 0.000, 150.000, 0.0000, 0.0000, 0.0000]
MOST = 500.000


def done(code):
    if code != 0:
        arm.set_state(4)
        sys.exit(f"the arm answers {code} and was stopped")


def go(x, y, z, speed, radius):
    done(arm.set_position(x, y, z, *UPRIGHT, radius or None, speed, MOST, is_radian=False, wait=False))


def arrive():
    done(arm.set_position(wait=True))


def rise(height, speed):
    code, here = arm.get_position(is_radian=False)
    done(code)
    if here[2] < height:
        done(arm.set_position(*here[:2], height, *here[3:], None, speed, MOST, is_radian=False, wait=True))


def rest(seconds):
    done(arm.set_pause_time(seconds))


def stop(message):
    arrive()
    input(message + ", then press Enter ")


arm = XArmAPI(sys.argv[1])
done(arm.motion_enable(True))
done(arm.set_world_offset([0, 0, 0, 0, 0, 0], is_radian=False))
done(arm.set_tcp_offset(TOOL, is_radian=False))
done(arm.set_mode(0))
done(arm.set_state(0))

# stroke 1 of 3: n/1
rise(40.000, 50.000)
go(-140.000, -490.000, 40.000, 100.000, None)
go(-140.000, -490.000, 22.000, 25.000, None)
go(-140.000, -490.000, 20.000, 10.000, None)
go(-137.500, -490.000, 17.000, 20.000, 0.031)
go(-119.877, -479.012, 16.750, 20.000, 0.122)
go(-110.000, -476.000, 16.750, 20.000, 0.000)
go(-112.000, -476.500, 20.000, 20.000, 0.000)
go(-112.000, -476.500, 22.000, 10.000, None)
go(-112.000, -476.500, 40.000, 100.000, None)

# stroke 2 of 3: dot
go(-110.000, -470.000, 40.000, 100.000, None)
go(-110.000, -470.000, 22.000, 25.000, None)
go(-110.000, -470.000, 20.000, 10.000, None)
go(-110.000, -470.000, 18.000, 10.000, 0.000)
go(-107.000, -470.000, 18.000, 20.000, 0.000)
go(-108.000, -470.000, 20.000, 20.000, 0.000)
go(-108.000, -470.000, 22.000, 10.000, None)
go(-108.000, -470.000, 40.000, 100.000, None)

# stroke 3 of 3: turn
go(-138.000, -490.000, 40.000, 100.000, None)
go(-138.000, -490.000, 22.000, 25.000, None)
go(-138.000, -490.000, 20.000, 10.000, None)
go(-138.000, -470.000, 18.000, 20.000, 0.200)
go(-137.751, -468.021, 18.000, 20.000, 0.128)
go(-137.021, -466.165, 18.000, 20.000, 0.127)
go(-135.854, -464.547, 18.000, 20.000, 0.127)
go(-134.322, -463.268, 18.000, 20.000, 0.127)
go(-132.523, -462.408, 18.000, 20.000, 0.127)
go(-130.566, -462.020, 18.000, 20.000, 0.127)
go(-128.574, -462.128, 18.000, 20.000, 0.127)
go(-126.671, -462.726, 18.000, 20.000, 0.026)
go(-120.000, -455.000, 18.000, 20.000, 0.000)
go(-120.000, -456.000, 20.000, 20.000, 0.000)
go(-120.000, -456.000, 22.000, 10.000, None)
go(-120.000, -456.000, 40.000, 100.000, None)

arrive()
arm.disconnect()
# end: the brush is held up
