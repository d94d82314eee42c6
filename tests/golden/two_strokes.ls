/PROG  BRUSHSVG
/ATTR
COMMENT		= "brushsvg";
PROTECT		= READ_WRITE;
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
 : !title: two strokes ;
 : PR[1]=LPOS ;
 : PR[1,1]=300.000 ;
 : PR[1,2]=(-150.000) ;
 : PR[1,3]=(-310.000) ;
 : PR[1,4]=0.00000 ;
 : PR[1,5]=0.00000 ;
 : PR[1,6]=0.00000 ;
 : UFRAME[1]=PR[1] ;
 : PR[1,1]=0.000 ;
 : PR[1,2]=0.000 ;
 : PR[1,3]=150.000 ;
 : PR[1,4]=0.00000 ;
 : PR[1,5]=0.00000 ;
 : PR[1,6]=0.00000 ;
 : UTOOL[1]=PR[1] ;
 : UFRAME_NUM=1 ;
 : UTOOL_NUM=1 ;
 : !stroke 1 of 3: n/1 ;
 : PR[2]=LPOS ;
 : R[1]=PR[2,3] ;
 : IF (R[1]<20.000) THEN ;
 : PR[2,3]=20.000 ;
 : L PR[2] 50mm/sec FINE ;
 : ENDIF ;
 : L P[1] 100mm/sec FINE ;
 : L P[2] 25mm/sec FINE ;
 : L P[3] 10mm/sec FINE ;
 : L P[4] 20mm/sec FINE ;
 : L P[5] 20mm/sec CNT3 ;
 : L P[6] 20mm/sec FINE ;
 : L P[7] 20mm/sec FINE ;
 : L P[8] 10mm/sec FINE ;
 : L P[9] 100mm/sec FINE ;
 : !stroke 2 of 3: dot ;
 : L P[10] 100mm/sec FINE ;
 : L P[11] 25mm/sec FINE ;
 : L P[12] 10mm/sec FINE ;
 : L P[13] 10mm/sec FINE ;
 : L P[14] 20mm/sec FINE ;
 : L P[15] 20mm/sec FINE ;
 : L P[16] 10mm/sec FINE ;
 : L P[17] 100mm/sec FINE ;
 : !stroke 3 of 3: turn ;
 : L P[18] 100mm/sec FINE ;
 : L P[19] 25mm/sec FINE ;
 : L P[20] 10mm/sec FINE ;
 : L P[21] 20mm/sec FINE ;
 : C P[22]
 :  P[23] 20mm/sec FINE ;
 : L P[24] 20mm/sec FINE ;
 : L P[25] 20mm/sec FINE ;
 : L P[26] 10mm/sec FINE ;
 : L P[27] 100mm/sec FINE ;
 : !end: the brush is held up ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 10.000  mm,	Y = 10.000  mm,	Z = 20.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[2]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 10.000  mm,	Y = 10.000  mm,	Z = 2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[3]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 10.000  mm,	Y = 10.000  mm,	Z = 0.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[4]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 12.500  mm,	Y = 10.000  mm,	Z = -3.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[5]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 30.123  mm,	Y = 20.988  mm,	Z = -3.250  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[6]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 40.000  mm,	Y = 24.000  mm,	Z = -3.250  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[7]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 38.000  mm,	Y = 23.500  mm,	Z = 0.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[8]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 38.000  mm,	Y = 23.500  mm,	Z = 2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[9]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 38.000  mm,	Y = 23.500  mm,	Z = 20.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[10]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 40.000  mm,	Y = 30.000  mm,	Z = 20.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[11]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 40.000  mm,	Y = 30.000  mm,	Z = 2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[12]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 40.000  mm,	Y = 30.000  mm,	Z = 0.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[13]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 40.000  mm,	Y = 30.000  mm,	Z = -2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[14]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 43.000  mm,	Y = 30.000  mm,	Z = -2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[15]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 42.000  mm,	Y = 30.000  mm,	Z = 0.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[16]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 42.000  mm,	Y = 30.000  mm,	Z = 2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[17]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 42.000  mm,	Y = 30.000  mm,	Z = 20.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[18]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 12.000  mm,	Y = 10.000  mm,	Z = 20.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[19]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 12.000  mm,	Y = 10.000  mm,	Z = 2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[20]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 12.000  mm,	Y = 10.000  mm,	Z = 0.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[21]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 12.000  mm,	Y = 30.000  mm,	Z = -2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[22]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 15.678  mm,	Y = 36.732  mm,	Z = -2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[23]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 23.329  mm,	Y = 37.274  mm,	Z = -2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[24]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 30.000  mm,	Y = 45.000  mm,	Z = -2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[25]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 30.000  mm,	Y = 44.000  mm,	Z = 0.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[26]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 30.000  mm,	Y = 44.000  mm,	Z = 2.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
P[27]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 30.000  mm,	Y = 44.000  mm,	Z = 20.000  mm,
	W = 180.000 deg,	P = 0.000 deg,	R = 0.000 deg
};
/END
