!> Exact kinematics of the arch as a four-hinge mechanism A-B-C-D (thesis 5.2.1, Fig. 5-1, B.1).
!>
!> The coordinate q >= 0 is the rotation of link AB from the undeformed arch, taken positive in
!> the sense in which the mechanism, driven to +x, turns (thesis: phi = theta_0 - theta). Nothing
!> is tabulated or linearised: B turns about A, C is the intersection of two circles.
module arch_four_hinge
   use common_kinds, only : wp, gravity
   use common_status, only : status_ok, status_bad_geometry
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: four_hinge, four_hinge_new, four_hinge_state, cross, normal, rotate

   type :: four_hinge
      real(wp) :: hinge(2, 4) = 0.0_wp     !! A, B, C, D in the undeformed arch [m]
      real(wp) :: mass(3) = 0.0_wp         !! of links AB, BC, CD [kg]
      real(wp) :: centroid(2, 3) = 0.0_wp  !! of the links [m]
      real(wp) :: inertia(3) = 0.0_wp      !! of the links about their centroids [kg m^2]
      real(wp) :: sense = 1.0_wp           !! +1: AB turns counter-clockwise for q > 0
      real(wp) :: branch = 1.0_wp          !! side of line BD on which C lies
      real(wp) :: bc2 = 0.0_wp, cd2 = 0.0_wp !! squares of the link lengths [m^2]
      real(wp) :: arm(2, 3) = 0.0_wp       !! from the undeformed pivot of each link to its centroid [m]
      real(wp) :: lock = 0.0_wp            !! greatest q the links allow [rad]
      real(wp) :: critical = 0.0_wp        !! q of unstable equilibrium under gravity [rad]
   contains
      procedure :: find_places
      procedure :: coefficients
      procedure :: potential
      procedure :: undeformed_pivot
   end type four_hinge

   !> Positions and derivatives by q of the three links
   type :: four_hinge_state
      logical :: closed          !! the links can still meet; the rest is known where they can
      real(wp) :: turn(3)        !! d(rotation)/dq of AB, BC, CD, counter-clockwise
      real(wp) :: turn2(3)       !! second derivative
      real(wp) :: cosine(3)      !! of the link rotations
      real(wp) :: sine(3)
      real(wp) :: pivot(2, 3)    !! a point of each link: A, B, D, displaced [m]
      real(wp) :: pivot1(2, 3)   !! its derivative by q
      real(wp) :: pivot2(2, 3)
   end type four_hinge_state

contains

   !> Set up a mechanism: sense of motion, branch, locking and critical rotation
   subroutine four_hinge_new(hinge, mass, centroid, inertia, mechanism, status)
      real(wp), intent(in) :: hinge(2, 4)     !! A, B, C, D [m]
      real(wp), intent(in) :: mass(3)         !! [kg]
      real(wp), intent(in) :: centroid(2, 3)  !! [m]
      real(wp), intent(in) :: inertia(3)      !! [kg m^2]
      type(four_hinge), intent(out) :: mechanism
      integer(c_int), intent(out) :: status   !! status_bad_geometry where the hinges make no mechanism
      real(wp) :: m, half_dm, dv, dh, low, high, q, previous
      integer :: i
      logical :: closed
      integer, parameter :: scan = 400

      mechanism%hinge = hinge
      mechanism%mass = mass
      mechanism%centroid = centroid
      mechanism%inertia = inertia
      mechanism%bc2 = sum((hinge(:, 3) - hinge(:, 2))**2)
      mechanism%cd2 = sum((hinge(:, 4) - hinge(:, 3))**2)
      do i = 1, 3
         mechanism%arm(:, i) = centroid(:, i) - mechanism%undeformed_pivot(i)
      end do
      mechanism%branch = sign(1.0_wp, cross(hinge(:, 4) - hinge(:, 2), hinge(:, 3) - hinge(:, 2)))
      status = status_bad_geometry
      call mechanism%coefficients(0.0_wp, m, half_dm, dv, dh, closed)
      if (.not. closed) return
      if (dh < 0.0_wp) mechanism%sense = -1.0_wp
      call mechanism%coefficients(0.0_wp, m, half_dm, dv, dh, closed)
      ! A mechanism that gravity does not hold shut is not one that an earthquake opens.
      if (.not. (closed .and. m > 0.0_wp .and. dh > 0.0_wp .and. dv > 0.0_wp)) return

      ! Walk out until the links lock or gravity turns over, then refine by bisection.
      low = 0.0_wp
      mechanism%lock = 0.0_wp
      mechanism%critical = 0.0_wp
      previous = 0.0_wp
      do i = 1, scan
         q = 1.6_wp * real(i, wp) / real(scan, wp)
         call mechanism%coefficients(q, m, half_dm, dv, dh, closed)
         if (.not. closed) then
            mechanism%lock = bisect(mechanism, previous, q, for_lock=.true.)
            exit
         end if
         if (dv <= 0.0_wp .and. mechanism%critical <= 0.0_wp) then
           mechanism%critical = bisect(mechanism, previous, q, for_lock=.false.)
         end if
         previous = q
      end do
      if (mechanism%lock <= 0.0_wp) mechanism%lock = 1.6_wp
      high = mechanism%lock
      if (mechanism%critical <= 0.0_wp) then
         ! Gravity resists up to the lock itself: the arch snaps through there.
         mechanism%critical = bisect(mechanism, low, high, for_lock=.true.)
      end if
      status = status_ok
   end subroutine four_hinge_new

   !> The q between low and high at which the links lock, or V' changes sign
   pure function bisect(mechanism, low, high, for_lock) result(q)
      type(four_hinge), intent(in) :: mechanism
      real(wp), intent(in) :: low
      real(wp), intent(in) :: high
      logical, intent(in) :: for_lock
      real(wp) :: q, a, b, m, half_dm, dv, dh
      logical :: closed
      integer :: i
      a = low
      b = high
      do i = 1, 60
         q = 0.5_wp * (a + b)
         call mechanism%coefficients(q, m, half_dm, dv, dh, closed)
         if (for_lock) then
            if (closed) then
               a = q
            else
               b = q
            end if
         else if (closed .and. dv > 0.0_wp) then
            a = q
         else
            b = q
         end if
      end do
      q = a
   end function bisect

   !> Link positions at q, with first and second derivatives
   pure subroutine find_places(arch, q, state)
      class(four_hinge), intent(in) :: arch
      real(wp), intent(in) :: q
      type(four_hinge_state), intent(out) :: state
      real(wp) :: ab(2), b(2), db(2), ddb(2), bd(2), per_distance2, along, height2, r(2), p(2)
      real(wp) :: r0(2), p0(2), per_turn, rp

      associate (a0 => arch%hinge(:, 1), b0 => arch%hinge(:, 2), c0 => arch%hinge(:, 3), d0 => arch%hinge(:, 4))
         state%cosine(1) = cos(q)
         state%sine(1) = arch%sense * sin(q)
         ab = rotate(b0 - a0, state%cosine(1), state%sine(1))
         b = a0 + ab
         db = arch%sense * normal(ab)
         ddb = -ab
         bd = d0 - b
         per_distance2 = 1.0_wp / dot_product(bd, bd)
         along = 0.5_wp + 0.5_wp * (arch%bc2 - arch%cd2) * per_distance2
         height2 = arch%bc2 * per_distance2 - along**2
         state%closed = height2 > 0.0_wp
         if (.not. state%closed) return

         r = along * bd + arch%branch * sqrt(height2) * normal(bd)
         p = r - bd
         ! What the rates of BC and CD are multiplied by: normal(p) . r, which is -normal(r) . p
         per_turn = 1.0_wp / cross(p, r)
         rp = dot_product(r, p)
         state%turn(1) = arch%sense
         state%turn(3) = dot_product(db, r) * per_turn
         state%turn(2) = dot_product(db, p) * per_turn
         state%turn2(1) = 0.0_wp
         state%turn2(3) = (dot_product(ddb, r) - state%turn(2)**2 * arch%bc2 + state%turn(3)**2 * rp) * per_turn
         state%turn2(2) = (dot_product(ddb, p) - state%turn(2)**2 * rp + state%turn(3)**2 * arch%cd2) * per_turn

         r0 = c0 - b0
         p0 = c0 - d0
         state%cosine(2) = dot_product(r0, r) / arch%bc2
         state%sine(2) = cross(r0, r) / arch%bc2
         state%cosine(3) = dot_product(p0, p) / arch%cd2
         state%sine(3) = cross(p0, p) / arch%cd2
         state%pivot(:, 1) = a0
         state%pivot(:, 2) = b
         state%pivot(:, 3) = d0
         state%pivot1(:, 1) = 0.0_wp
         state%pivot1(:, 2) = db
         state%pivot1(:, 3) = 0.0_wp
         state%pivot2(:, 1) = 0.0_wp
         state%pivot2(:, 2) = ddb
         state%pivot2(:, 3) = 0.0_wp
      end associate
   end subroutine find_places

   !> Coefficients of M q'' + (1/2) M' q'^2 + V' (1 + a_v/g) + side a_h H = 0 (thesis Eqs 5.1, 5.2, B.2)
   pure subroutine coefficients(arch, q, m, half_dm, dv, dh, closed)
      class(four_hinge), intent(in) :: arch
      real(wp), intent(in) :: q         !! rotation of AB [rad]
      real(wp), intent(out) :: m        !! generalised mass M [kg m^2]
      real(wp), intent(out) :: half_dm  !! (1/2) dM/dq [kg m^2]
      real(wp), intent(out) :: dv       !! dV/dq of gravity [N m]
      real(wp), intent(out) :: dh       !! H = sum m dx/dq in the sense of motion [kg m]
      logical, intent(out) :: closed    !! false past the rotation at which the links lock
      type(four_hinge_state) :: state
      real(wp) :: arm(2), dx(2), ddx(2), mass, half_slope, lift, drive
      integer :: i

      mass = 0.0_wp
      half_slope = 0.0_wp
      lift = 0.0_wp
      drive = 0.0_wp
      call arch%find_places(q, state)
      closed = state%closed
      if (closed) then
         do i = 1, 3
            arm = rotate(arch%arm(:, i), state%cosine(i), state%sine(i))
            dx = state%pivot1(:, i) + state%turn(i) * normal(arm)
            ddx = state%pivot2(:, i) + state%turn2(i) * normal(arm) - state%turn(i)**2 * arm
            mass = mass + arch%mass(i) * dot_product(dx, dx) + arch%inertia(i) * state%turn(i)**2
            half_slope = half_slope + arch%mass(i) * dot_product(dx, ddx) &
               + arch%inertia(i) * state%turn(i) * state%turn2(i)
            lift = lift + arch%mass(i) * dx(2)
            drive = drive + arch%mass(i) * dx(1)
         end do
      end if
      m = mass
      half_dm = half_slope
      dv = gravity * lift
      dh = drive
   end subroutine coefficients

   !> Potential energy of gravity above the undeformed arch [J]; the links must be able to meet at q
   pure function potential(arch, q) result(v)
      class(four_hinge), intent(in) :: arch
      real(wp), intent(in) :: q
      real(wp) :: v
      type(four_hinge_state) :: state
      real(wp) :: arm(2)
      integer :: i
      call arch%find_places(q, state)
      v = 0.0_wp
      do i = 1, 3
         arm = rotate(arch%arm(:, i), state%cosine(i), state%sine(i))
         v = v + gravity * arch%mass(i) * (state%pivot(2, i) + arm(2) - arch%centroid(2, i))
      end do
   end function potential

   !> The point about which a link's displacement is written: A, B, D of the undeformed arch
   pure function undeformed_pivot(arch, link) result(point)
      class(four_hinge), intent(in) :: arch
      integer, intent(in) :: link  !! 1 = AB, 2 = BC, 3 = CD
      real(wp) :: point(2)
      point = arch%hinge(:, merge(4, link, link == 3))
   end function undeformed_pivot

   !> Counter-clockwise normal of a vector
   pure function normal(vector) result(n)
      real(wp), intent(in) :: vector(2)
      real(wp) :: n(2)
      n = [-vector(2), vector(1)]
   end function normal

   pure function cross(u, v) result(c)
      real(wp), intent(in) :: u(2)
      real(wp), intent(in) :: v(2)
      real(wp) :: c
      c = u(1) * v(2) - u(2) * v(1)
   end function cross

   pure function rotate(vector, cosine, sine) result(turned)
      real(wp), intent(in) :: vector(2)
      real(wp), intent(in) :: cosine
      real(wp), intent(in) :: sine
      real(wp) :: turned(2)
      turned = [cosine * vector(1) - sine * vector(2), sine * vector(1) + cosine * vector(2)]
   end function rotate

end module arch_four_hinge
