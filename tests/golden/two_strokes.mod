MODULE brushsvg
  ! title: two strokes
  LOCAL PERS tooldata brush := [TRUE, [[0.000, 0.000, 150.000], [1.0000000, 0.0000000, 0.0000000, 0.0000000]], [0.5, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0]];
  LOCAL PERS wobjdata paper := [FALSE, TRUE, "", [[-160.000, -460.000, 20.000], [1.0000000, 0.0000000, 0.0000000, 0.0000000]], [[0, 0, 0], [1, 0, 0, 0]]];
  LOCAL VAR robtarget here;

  FUNC robtarget on_paper(num x, num y, num z)
    RETURN [[x, y, z], [0.0000000, 1.0000000, 0.0000000, 0.0000000], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  ENDFUNC

  FUNC speeddata mm_s(num speed)
    RETURN [speed, 500, 5000, 1000];
  ENDFUNC

  FUNC zonedata within(num radius)
    IF radius = 0 THEN
      RETURN fine;
    ENDIF
    RETURN [FALSE, radius, radius, radius, 0.1, radius, 0.1];
  ENDFUNC

  PROC paint()
    ConfL \Off;
    PathAccLim TRUE \AccMax:=0.500, TRUE \DecelMax:=0.500;

  ! stroke 1 of 3: n/1
    here := CRobT(\Tool:=brush \WObj:=paper);
    IF here.trans.z < 20.000 THEN
      here.trans.z := 20.000;
      MoveL here, mm_s(50.000), fine, brush\WObj:=paper;
    ENDIF
    MoveL on_paper(10.000, 10.000, 20.000), mm_s(100.000), fine, brush\WObj:=paper;
    MoveL on_paper(10.000, 10.000, 2.000), mm_s(25.000), fine, brush\WObj:=paper;
    MoveL on_paper(10.000, 10.000, 0.000), mm_s(10.000), fine, brush\WObj:=paper;
    MoveL on_paper(12.500, 10.000, -3.000), mm_s(20.000), within(0.039), brush\WObj:=paper;
    MoveL on_paper(30.123, 20.988, -3.250), mm_s(20.000), within(0.152), brush\WObj:=paper;
    MoveL on_paper(40.000, 24.000, -3.250), mm_s(20.000), within(0.000), brush\WObj:=paper;
    MoveL on_paper(38.000, 23.500, 0.000), mm_s(20.000), within(0.000), brush\WObj:=paper;
    MoveL on_paper(38.000, 23.500, 2.000), mm_s(10.000), fine, brush\WObj:=paper;
    MoveL on_paper(38.000, 23.500, 20.000), mm_s(100.000), fine, brush\WObj:=paper;

  ! stroke 2 of 3: dot
    MoveL on_paper(40.000, 30.000, 20.000), mm_s(100.000), fine, brush\WObj:=paper;
    MoveL on_paper(40.000, 30.000, 2.000), mm_s(25.000), fine, brush\WObj:=paper;
    MoveL on_paper(40.000, 30.000, 0.000), mm_s(10.000), fine, brush\WObj:=paper;
    MoveL on_paper(40.000, 30.000, -2.000), mm_s(10.000), within(0.000), brush\WObj:=paper;
    MoveL on_paper(43.000, 30.000, -2.000), mm_s(20.000), within(0.000), brush\WObj:=paper;
    MoveL on_paper(42.000, 30.000, 0.000), mm_s(20.000), within(0.000), brush\WObj:=paper;
    MoveL on_paper(42.000, 30.000, 2.000), mm_s(10.000), fine, brush\WObj:=paper;
    MoveL on_paper(42.000, 30.000, 20.000), mm_s(100.000), fine, brush\WObj:=paper;

  ! stroke 3 of 3: turn
    MoveL on_paper(12.000, 10.000, 20.000), mm_s(100.000), fine, brush\WObj:=paper;
    MoveL on_paper(12.000, 10.000, 2.000), mm_s(25.000), fine, brush\WObj:=paper;
    MoveL on_paper(12.000, 10.000, 0.000), mm_s(10.000), fine, brush\WObj:=paper;
    MoveL on_paper(12.000, 30.000, -2.000), mm_s(20.000), within(0.000), brush\WObj:=paper;
    MoveC on_paper(15.678, 36.732, -2.000), on_paper(23.329, 37.274, -2.000), mm_s(20.000), fine, brush\WObj:=paper;
    MoveL on_paper(30.000, 45.000, -2.000), mm_s(20.000), within(0.000), brush\WObj:=paper;
    MoveL on_paper(30.000, 44.000, 0.000), mm_s(20.000), within(0.000), brush\WObj:=paper;
    MoveL on_paper(30.000, 44.000, 2.000), mm_s(10.000), fine, brush\WObj:=paper;
    MoveL on_paper(30.000, 44.000, 20.000), mm_s(100.000), fine, brush\WObj:=paper;

  ! end: the brush is held up
  ENDPROC
ENDMODULE
