!> What a joint bears before it leaves its limits, as its regions are told, against a search: displacements are changed
!> in all directions by as much energy as it takes until `scan` admits the multiplier no more.
program test_sla_margin
   use common_kinds, only : wp
   use common_status, only : status_ok
   use common_lists, only : law_linear => sla_law_linear, law_exponential => sla_law_exponential
   use sla_group, only : material_options, scan_result
   use sla_interface, only : interface_group, interface_group_new, joint_law, joint_law_new
   use sla_tables, only : tooth_tables, tooth_tables_new
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   real(wp), parameter :: kn = 82.0e9_wp, ks = 36.0e9_wp, length = 1.0e-6_wp
   integer, parameter :: mortar = 1, dry = 2, virgin = 3, states = 600
   type(interface_group) :: group
   real(wp) :: ua(0:8), ub(0:8), lambda(2), told(2), found
   integer :: kind, i, j, tight, positive

   do kind = mortar, virgin
      tight = 0
      positive = 0
      do i = 1, states
         call make(kind, group)
         call disturb(kind)
         ua = 0.0_wp
         ub = 0.0_wp
         do j = 1, 8
            ua(j) = length * draw(-1.0_wp, 1.0_wp)
            ub(j) = length * draw(-1.0_wp, 1.0_wp)
         end do
         if (mod(i, 3) > 0) call press(merge(3.0_wp, 23.0_wp, mod(i, 3) == 1) * length, ua)
         lambda = [draw(-1.0_wp, 0.0_wp), draw(0.0_wp, 1.0_wp)]
         told = huge(1.0_wp)
         call group%margin(1, 1, ua, ub, lambda, told)
         do j = 1, 2
            found = least_energy(lambda(j))
            if (.not. found > 0.0_wp) then
               if (told(j) > 0.0_wp) error stop 'a joint beyond its limits is left waiting'
               cycle
            end if
            positive = positive + 1
            if (told(j) > 1.001_wp * found) error stop 'a joint that waits leaves its limits'
            if (told(j) > 0.999_wp * found) tight = tight + 1
         end do
      end do
      print '(a, i0, a, i0, a, i0)', 'joint ', kind, ': ', tight, ' of ', positive
      if (positive < states / 4) error stop 'most states were beyond their limits: nothing was compared'
      ! Of what has slipped it is on the safe side: that bond and friction act side by side is left out
      if (tight < merge(positive / 8, positive, kind == mortar)) error stop 'a joint waits less than it may'
   end do

contains

   !> A joint of one element, of mortar or dry
   subroutine make(kind, group)
      integer, intent(in) :: kind
      type(interface_group), intent(out) :: group
      type(joint_law) :: law
      type(tooth_tables) :: teeth
      type(material_options) :: options
      real(wp) :: rows(8, 3)
      integer(c_int) :: bad, status
      integer :: k
      rows(:, 1) = [real(law_exponential, wp), kn, 0.25e6_wp, 18.0_wp, 1.0_wp, 0.1_wp, 1.0_wp, 1.0_wp]
      rows(:, 2) = [real(law_exponential, wp), ks, 0.35e6_wp, 125.0_wp, 1.0_wp, 0.1_wp, 1.0_wp, 1.0_wp]
      rows(:, 3) = [real(law_linear, wp), kn, 2.0e6_wp, 5000.0_wp, 1.0_wp, 0.1_wp, 1.0_wp, 1.0_wp]
      call tooth_tables_new(rows, teeth, bad, status)
      if (status == status_ok) call joint_law_new(1, law, status)
      if (status /= status_ok) error stop 'no joint'
      law%kn = kn
      law%ks = ks
      law%friction = 0.75_wp
      law%small = 1.0_wp
      law%table = merge(0_c_int, 1_c_int, kind == dry)
      law%slip_table = merge(0_c_int, 2_c_int, kind == dry)
      law%crush_table = 3_c_int
      law%dry = merge(1_c_int, 0_c_int, kind == dry)
      options%floor = 1.0e-6_wp
      options%closure = .true.
      call interface_group_new(reshape([0.02_wp, 0.03_wp], [2, 1]), reshape([0.6_wp, 0.8_wp], [2, 1]), law, teeth, &
         options, group, bad, status)
      if (status /= status_ok) error stop 'no element'
      allocate (group%equation(8, 1), group%factor(8, 1))
      group%equation(:, 1) = [(int(k, c_int), k=1, 8)]
      group%factor = 1.0_wp
   end subroutine make

   !> Some damage that such a joint can have, no point sliding
   subroutine disturb(kind)
      integer, intent(in) :: kind
      integer :: p
      do p = 1, 2
         group%crush(p) = int(draw(1.0_wp, 4.0_wp), c_int)
         if (kind == dry) then
            group%shut(p) = int(draw(0.0_wp, 2.0_wp), c_int)
            group%mark(p) = 0.3_wp * length * draw(-1.0_wp, 1.0_wp)
         else if (kind == mortar) then
            group%tooth(p) = int(draw(2.0_wp, 5.0_wp), c_int)
            group%slip(p) = int(draw(2.0_wp, 5.0_wp), c_int)
            group%shut(p) = int(draw(0.0_wp, 2.0_wp), c_int)
            group%start(p) = 0.3_wp * length * draw(-1.0_wp, 1.0_wp)
            group%mark(p) = 0.3_wp * length * draw(-1.0_wp, 1.0_wp)
         end if
      end do
   end subroutine disturb

   !> Let both points be pressed, some so much that they nearly crush
   subroutine press(closer, u)
      real(wp), intent(in) :: closer             !! [m]
      real(wp), intent(inout) :: u(0:)
      u([5, 7]) = u([5, 7]) - 0.6_wp * closer
      u([6, 8]) = u([6, 8]) - 0.8_wp * closer
   end subroutine press

   !> Least sqrt(2 U) [J^1/2] of a change of the displacements by which a multiplier is no longer admitted, by search
   function least_energy(at) result(least)
      real(wp), intent(in) :: at
      real(wp) :: least, k(8, 8), v(8), low, high, middle, angle
      integer, parameter :: directions = 720
      integer :: p, d, step, nodes(2)
      least = 0.0_wp
      if (left(at, [(0.0_wp, p=1, 8)])) return
      least = huge(1.0_wp)
      call group%matrix(1, k)
      do p = 1, 2
         nodes = merge([1, 7], [3, 5], p == 1)     ! first freedoms below and above
         do d = 1, directions
            angle = 8.0_wp * atan(1.0_wp) * real(d, wp) / real(directions, wp)
            v = 0.0_wp
            v(nodes(2):nodes(2) + 1) = opening(k, nodes(2), cos(angle), sin(angle))
            high = least
            if (high > 1.0e3_wp) high = 1.0e3_wp
            if (.not. left(at, high * v)) cycle
            low = 0.0_wp
            do step = 1, 60
               middle = 0.5_wp * (low + high)
               if (left(at, middle * v)) then
                  high = middle
               else
                  low = middle
               end if
            end do
            least = min(least, high)
         end do
      end do
   end function least_energy

   !> Jump across (share c) and along (share s) the joint whose energy in the stiffness is a half
   pure function opening(k, node, c, s) result(u)
      real(wp), intent(in) :: k(8, 8)
      integer, intent(in) :: node      !! its first freedom
      real(wp), intent(in) :: c, s
      real(wp) :: u(2), n(2), t(2)
      n = [0.6_wp, 0.8_wp]
      t = [0.8_wp, -0.6_wp]
      associate (part => k(node:node + 1, node:node + 1))
         u = c * n / sqrt(dot_product(n, matmul(part, n))) + s * t / sqrt(dot_product(t, matmul(part, t)))
      end associate
   end function opening

   !> Does the joint no longer admit a multiplier after its displacements changed by v?
   function left(at, v) result(yes)
      real(wp), intent(in) :: at
      real(wp), intent(in) :: v(8)
      logical :: yes
      type(scan_result) :: limits
      real(wp) :: changed(0:8)
      changed = ua
      changed(1:) = changed(1:) + v
      limits = scan_result()
      call group%scan(1, 1, changed, ub, at, 0.0_wp, limits)
      yes = limits%empty%point /= 0 .or. .not. limits%hi%value > at .or. .not. limits%lo%value < at
   end function left

   !> Numbers of a fixed sequence, evenly between two
   function draw(from, to) result(value)
      real(wp), intent(in) :: from, to
      real(wp) :: value
      integer, save :: seed = 20261
      seed = mod(seed * 3877 + 29573, 139968)
      value = from + (to - from) * real(seed, wp) / 139968.0_wp
   end function draw

end program test_sla_margin
