!> Interfaces of no thickness: joints that open, slide and crush.
!>
!> An element is a stretch of a joint, nodes 1 to 2 along its lower and 3 to 4 back along its upper side, with one
!> integration point at each pair of nodes; that of a pair between two elements stands in one of them. The law of a
!> point is that of sla_joint_points.
module sla_interface
   use common_kinds, only : wp
   use common_lists, only : code_tension => sla_event_tension, code_compression => sla_event_compression, &
      code_close => sla_event_close, code_open => sla_event_open, code_wear => sla_event_wear, &
      code_slide => sla_event_slide
   use common_status, only : status_ok, status_out_of_memory, status_bad_geometry
   use sla_group, only : scan_result, slider, event_vectors, material_options, admitted, unbounded, most_entries
   use sla_joint_history, only : joint_history
   use sla_joint_points, only : joint_law, joint_law_new, line, sticks, slides_up, slides_down, soft, &
      jump, nodal, across, along, shear, bond, bond_of, modulus, slips, is_closed, is_sliding, &
      scan_point
   use sla_tables, only : tooth_tables, tooth_tables_copy
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: interface_group, interface_group_new, interface_between_shells, joint_law, joint_law_new

   !> Loads that are the same
   real(wp), parameter :: same = 1.0e-9_wp

   type, extends(joint_history) :: interface_group
   contains
      procedure :: matrix
      procedure :: force
      procedure :: damage
      procedure :: report
      procedure :: state
      procedure :: origins
      procedure :: slipped
      procedure :: sliding
      procedure :: sliders
      procedure :: turned_back
      procedure :: undecided
      procedure :: set_held
      procedure :: advance
      procedure :: excess
      procedure :: elastic
   end type interface_group

contains

   !> A group of joints without damage
   subroutine interface_group_new(area, normal, law, teeth, options, group, bad, status)
      real(wp), intent(in) :: area(:, :)           !! (2, elements) of the points [m^2]; 0: in the next element
      real(wp), intent(in) :: normal(:, :)         !! (2, elements) unit vectors from the lower to the upper side
      type(joint_law), intent(in) :: law
      type(tooth_tables), intent(in) :: teeth
      type(material_options), intent(in) :: options
      type(interface_group), intent(out) :: group
      integer(c_int), intent(out) :: bad           !! element without area or normal, 1-based
      integer(c_int), intent(out) :: status
      integer :: e, n, p, info

      n = size(area, 2)
      bad = 0
      status = status_out_of_memory
      group%elements = n
      group%points = 2 * n
      group%freedoms = 8
      group%directions = 1
      group%slides = any(law%friction >= 0.0_wp)
      group%options = options
      call tooth_tables_copy(teeth, group%teeth, status)
      if (status /= status_ok) return
      call joint_law_new(n, group%law, status)
      if (status /= status_ok) return
      group%law%kn(:) = law%kn
      group%law%ks(:) = law%ks
      group%law%friction(:) = law%friction
      group%law%small(:) = law%small
      group%law%table(:) = law%table
      group%law%crush_table(:) = law%crush_table
      group%law%slip_table(:) = law%slip_table
      group%law%dry(:) = law%dry
      group%law%ripple = law%ripple
      status = status_out_of_memory
      allocate (group%normal(2, n), group%area(2 * n), group%tooth(2 * n), group%crush(2 * n), group%slip(2 * n), &
         group%shut(2 * n), group%changes(2 * n), group%mode(2 * n), group%even(2 * n), group%start(2 * n), &
         group%mark(2 * n), group%held(2, 2 * n), &
         group%stuck(2 * n), stat=info)
      if (info /= 0) return
      group%normal(:, :) = normal
      group%crush = 1
      group%changes = 0
      group%mode = sticks
      group%even = 0
      group%start = 0.0_wp
      group%mark = 0.0_wp
      group%held = 0.0_wp
      group%stuck = unbounded
      do e = 1, n
         if (.not. all(area(:, e) >= 0.0_wp) .or. .not. any(area(:, e) > 0.0_wp) .or. &
             .not. abs(norm2(normal(:, e)) - 1.0_wp) < 1.0e-9_wp) then
            bad = int(e, c_int)
            status = status_bad_geometry
            return
         end if
         group%area(2 * e - 1:2 * e) = area(:, e)
         do p = 2 * e - 1, 2 * e
            group%tooth(p) = merge(2_c_int, 1_c_int, law%dry(e) /= 0)
            group%shut(p) = merge(1_c_int, 0_c_int, law%dry(e) /= 0)
            group%slip(p) = merge(2_c_int, 1_c_int, law%slip_table(e) == 0)
         end do
      end do
      status = status_ok
   end subroutine interface_group_new

   !> Make the elements of a new group layers of joints between shells, whose nodes have six freedoms
   subroutine interface_between_shells(group, row, status)
      type(interface_group), intent(inout) :: group
      real(wp), intent(in) :: row(:, :, :)         !! (24, 3, points), see joint_points
      integer(c_int), intent(out) :: status
      integer :: info
      allocate (group%row(size(row, 1), 3, group%points), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      group%freedoms = size(row, 1)
      group%row(:, :, :) = row
   end subroutine interface_between_shells

   pure subroutine matrix(group, element, k)
      class(interface_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(out) :: k(:, :)
      real(wp) :: n(most_entries), t(most_entries), kn, kt
      type(line) :: law
      integer :: p, i, f
      k = 0.0_wp
      f = group%freedoms
      do p = 2 * element - 1, 2 * element
         law = along(group, element, p)
         kn = group%area(p) * across(group, element, p)
         kt = group%area(p) * law%k
         n = nodal(group, element, p, [1.0_wp, 0.0_wp])
         t = nodal(group, element, p, [0.0_wp, 1.0_wp])
         do i = 1, f
            k(1:f, i) = k(1:f, i) + kn * n(1:f) * n(i) + kt * t(1:f) * t(i)
         end do
         if (.not. allocated(group%row)) cycle
         associate (w => group%row(:, 3, p))
            do i = 1, f
               k(1:f, i) = k(1:f, i) + group%area(p) * group%law%ks(element) * w * w(i)
            end do
         end associate
      end do
   end subroutine matrix

   pure subroutine force(group, u, f)
      class(interface_group), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: f(0:)
      real(wp) :: local(most_entries), d(2), pull
      type(line) :: law
      integer :: e, p, i, n
      do e = 1, group%elements
         call group%gather(e, u, local)
         do p = 2 * e - 1, 2 * e
            law = along(group, e, p)
            d = jump(group, e, p, local)
            call add_point_forces(group, e, p, [across(group, e, p) * d(1), law%k * d(2)], f)
            if (.not. allocated(group%row)) cycle
            n = group%freedoms
            associate (w => group%row(:, 3, p))
               pull = group%area(p) * group%law%ks(e) * dot_product(w, local(1:n))
               do i = 1, n
                  f(group%equation(i, e)) = f(group%equation(i, e)) + pull * w(i) * group%factor(i, e)
               end do
            end associate
         end do
      end do
   end subroutine force

   !> Add the forces of the stresses s of a point
   pure subroutine add_point_forces(group, e, p, s, f)
      class(interface_group), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: s(2)      !! sigma, tau [Pa]
      real(wp), intent(inout) :: f(0:)
      real(wp) :: part(most_entries)
      integer :: i
      part = nodal(group, e, p, group%area(p) * s)
      do i = 1, group%freedoms
         f(group%equation(i, e)) = f(group%equation(i, e)) + part(i) * group%factor(i, e)
      end do
   end subroutine add_point_forces

   pure function slipped(group) result(yes)
      class(interface_group), intent(in) :: group
      logical :: yes
      integer :: p
      yes = .false.
      if (.not. group%slides) return
      do p = 1, group%points
         yes = is_closed(group, p) .and. (group%mode(p) /= sticks .or. abs(group%mark(p)) > 0.0_wp)
         if (yes) return
      end do
   end function slipped

   !> Forces and energy of springs that do not begin at zero slip, and forces of sliding friction
   pure subroutine origins(group, springs, held, energy)
      class(interface_group), intent(in) :: group
      real(wp), intent(inout) :: springs(0:)
      real(wp), intent(inout) :: held(0:, :)
      real(wp), intent(inout) :: energy
      type(line) :: law
      integer :: e, p, i
      do p = 1, group%points
         e = (p + 1) / 2
         law = along(group, e, p)
         energy = energy + group%area(p) * law%e0
         if (abs(law%k0) > 0.0_wp) call add_point_forces(group, e, p, [0.0_wp, law%k0], springs)
         do i = 1, 2
            if (abs(law%h(i)) > 0.0_wp) call add_point_forces(group, e, p, [0.0_wp, -law%h(i)], held(:, i))
         end do
      end do
   end subroutine origins

   pure function sliding(group) result(count)
      class(interface_group), intent(in) :: group
      integer :: count, p
      count = 0
      do p = 1, group%points
         if (is_sliding(group, p)) count = count + 1
      end do
   end function sliding

   pure subroutine sliders(group, list, count)
      class(interface_group), intent(in) :: group
      type(slider), intent(inout) :: list(:)
      integer, intent(inout) :: count
      integer :: p
      do p = 1, group%points
         if (.not. is_sliding(group, p)) cycle
         count = count + 1
         call describe_friction(group, p, list(count))
      end do
   end subroutine sliders

   pure subroutine turned_back(group, lambda, list, count)
      class(interface_group), intent(in) :: group
      real(wp), intent(in) :: lambda
      type(slider), intent(inout) :: list(:)
      integer, intent(inout) :: count
      integer :: p
      do p = 1, group%points
         if (group%mode(p) /= sticks .or. .not. abs(lambda - group%stuck(p)) <= same * abs(lambda)) cycle
         if (.not. is_closed(group, p)) cycle
         count = count + 1
         if (count <= size(list)) call describe_friction(group, p, list(count))
      end do
   end subroutine turned_back

   !> What the friction of a point at its limit is made of
   pure subroutine describe_friction(group, point, as)
      class(interface_group), intent(in) :: group
      integer, intent(in) :: point
      type(slider), intent(inout) :: as
      integer :: e, p, n
      p = point
      e = (p + 1) / 2
      as%point = p
      n = group%freedoms
      as%entries = n
      as%index(1:n) = group%equation(:, e)
      as%across = nodal(group, e, p, [1.0_wp, 0.0_wp])
      as%across(1:n) = as%across(1:n) * group%factor(:, e)
      as%slip = nodal(group, e, p, [0.0_wp, 1.0_wp])
      as%slip(1:n) = as%slip(1:n) * group%factor(:, e)
      as%area = group%area(p)
      as%strength = -group%law%friction(e) * across(group, e, p)
      as%elastic = shear(group, e, p) - bond(group, e, p)
      if (group%mode(p) == sticks) then
         as%spring = as%elastic
         as%held = [-as%spring * group%mark(p), 0.0_wp]
         return
      end if
      as%sense = merge(1.0_wp, -1.0_wp, group%mode(p) == slides_up)
      as%law = [as%sense * as%strength, -soft * shear(group, e, p)]
      as%spring = soft * shear(group, e, p)
      as%held = group%held(:, p)
   end subroutine describe_friction

   pure function undecided(group, point, code, lambda) result(yes)
      class(interface_group), intent(in) :: group
      integer, intent(in) :: point
      integer, intent(in) :: code
      real(wp), intent(in) :: lambda
      logical :: yes
      yes = code == code_slide .and. abs(lambda - group%stuck(point)) <= same * abs(lambda)
   end function undecided

   pure subroutine set_held(group, point, held)
      class(interface_group), intent(inout) :: group
      integer, intent(in) :: point
      real(wp), intent(in) :: held(2)
      group%held(:, point) = held
   end subroutine set_held

   pure function excess(group, u) result(energy)
      class(interface_group), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp) :: energy, local(most_entries), d(2)
      integer :: e, p
      energy = 0.0_wp
      do p = 1, group%points
         if (.not. is_sliding(group, p)) cycle
         e = (p + 1) / 2
         call group%gather(e, u, local)
         d = jump(group, e, p, local)
         energy = energy + 0.5_wp * group%area(p) * soft * shear(group, e, p) * d(2)**2
      end do
   end function excess

   pure function elastic(group, lambda, u) result(energy)
      class(interface_group), intent(in) :: group
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: u(0:)
      real(wp) :: energy, local(most_entries), d(2), friction
      integer :: e, p
      energy = 0.0_wp
      do p = 1, group%points
         if (.not. is_sliding(group, p)) cycle
         e = (p + 1) / 2
         call group%gather(e, u, local)
         d = jump(group, e, p, local)
         friction = group%held(1, p) + lambda * group%held(2, p) + soft * shear(group, e, p) * d(2)
         energy = energy + 0.5_wp * group%area(p) * friction**2 / (shear(group, e, p) - bond(group, e, p))
      end do
   end function elastic

   pure subroutine advance(group, lambda, ua, ub)
      class(interface_group), intent(inout) :: group
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp) :: local(most_entries), other(most_entries), d(2), friction, slip
      integer :: e, p
      do p = 1, group%points
         if (.not. is_sliding(group, p)) cycle
         e = (p + 1) / 2
         call group%gather(e, ua, local)
         call group%gather(e, ub, other)
         d = jump(group, e, p, local + lambda * other)
         friction = group%held(1, p) + lambda * group%held(2, p) + soft * shear(group, e, p) * d(2)
         slip = inelastic_slip(group, e, p, d(2), friction)
         if (group%mode(p) == slides_up) group%mark(p) = max(group%mark(p), slip)
         if (group%mode(p) == slides_down) group%mark(p) = min(group%mark(p), slip)
      end do
   end subroutine advance

   pure subroutine damage(group, point, code, lambda, ua, ub, event, tooth)
      class(interface_group), intent(inout) :: group
      integer, intent(in) :: point
      integer, intent(in) :: code
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(event_vectors), intent(out) :: event
      integer, intent(out) :: tooth
      real(wp) :: local(most_entries), other(most_entries), d(2), moved(2), normal(2), strength, change, friction
      type(line) :: old, new
      integer :: e, p

      p = point
      e = (p + 1) / 2
      call group%gather(e, ua, local)
      call group%gather(e, ub, other)
      d = jump(group, e, p, local + lambda * other)
      moved = jump(group, e, p, other)
      normal(1) = across(group, e, p)
      old = along(group, e, p)
      associate (law => group%law)
         strength = max(-law%friction(e) * normal(1) * d(1), 0.0_wp)
         friction = group%held(1, p) + lambda * group%held(2, p) + soft * shear(group, e, p) * d(2)
         tooth = 0
         select case (code)
         case (code_tension)
            group%tooth(p) = group%tooth(p) + 1_c_int
            group%shut(p) = 0
            if (law%slip_table(e) /= 0) call wear_with(group%teeth, law%table(e), group%tooth(p), law%slip_table(e), &
               group%slip(p))
            tooth = int(group%tooth(p))
         case (code_compression)
            group%crush(p) = group%crush(p) + 1_c_int
            tooth = int(group%crush(p))
         case (code_open, code_close)
            group%shut(p) = merge(1_c_int, 0_c_int, code == code_close)
            group%changes(p) = group%changes(p) + 1_c_int
            ! What closes slides on as it comes; what moves neither way sticks at once
            group%mode(p) = sticks
            if (code == code_close .and. slips(group, e, p)) then
               group%mode(p) = merge(slides_up, slides_down, moved(2) > 0.0_wp)
            end if
            group%mark(p) = d(2)
            group%held(:, p) = 0.0_wp
            if (group%mode(p) /= sticks) call begin_sliding(group, e, p, 0.0_wp, d, moved, lambda)
            tooth = int(group%changes(p))
         case (code_wear)
            if (group%slip(p) == 1) then
               ! The first slip: friction carries what it can, the cohesion the rest
               group%mode(p) = merge(slides_up, slides_down, d(2) > 0.0_wp)
               group%start(p) = strength / law%ks(e)
               friction = sign(strength, d(2))
            end if
            event%crack = 0.5_wp * group%area(p) * (modulus(group, e, group%slip(p)) - &
               modulus(group, e, group%slip(p) + 1_c_int)) * (abs(d(2)) - group%start(p))**2
            group%slip(p) = group%slip(p) + 1_c_int
            if (group%mode(p) /= sticks) then
               call begin_sliding(group, e, p, friction, d, moved, lambda)
            else   ! friction keeps its force, with more stiffness
               friction = (shear(group, e, p) - bond_of(group, e, p, group%slip(p) - 1_c_int)) * &
                  (d(2) - group%mark(p))
            end if
            group%mark(p) = inelastic_slip(group, e, p, d(2), friction)
            if (law%table(e) /= 0) then
               call wear_with(group%teeth, law%slip_table(e), group%slip(p), law%table(e), group%tooth(p))
               if (group%tooth(p) > 1 .and. d(1) <= 0.0_wp) group%shut(p) = 1
            end if
            tooth = int(group%slip(p))
         case (code_slide)
            change = (shear(group, e, p) - bond(group, e, p)) * (d(2) - group%mark(p))
            group%mode(p) = merge(slides_up, slides_down, change > 0.0_wp)
            call begin_sliding(group, e, p, change, d, moved, lambda)
         case default
            group%mark(p) = inelastic_slip(group, e, p, d(2), friction)
            group%mode(p) = sticks
            group%held(:, p) = 0.0_wp
            group%stuck(p) = lambda
         end select
      end associate
      event%cracks = code == code_tension .or. code == code_compression
      new = along(group, e, p)
      if (any(abs(new%h - old%h) > 0.0_wp) .or. abs(new%k0 - old%k0) > 0.0_wp) then
         if (.not. abs(new%k - old%k) > 0.0_wp) then
            group%even(p) = 1_c_int - group%even(p)
            new = along(group, e, p)
         end if
      end if
      normal(2) = across(group, e, p)
      change = normal(1) - normal(2)
      if (abs(change) > 0.0_wp) call add_vector(group, e, p, [1.0_wp, 0.0_wp], change, event)
      change = old%k - new%k
      if (.not. abs(change) > 0.0_wp) return
      call add_vector(group, e, p, [0.0_wp, 1.0_wp], change, event)
      associate (r => event%rank, share => sqrt(group%area(p) / abs(change)))
         event%origin(r) = event%sign(r) * share * (old%k0 - new%k0)
         event%hold(:, r) = event%sign(r) * share * (new%h - old%h)
         event%shift = group%area(p) * (new%e0 - old%e0)
      end associate
   end subroutine damage

   !> Slip but for what is elastic in its friction [m]
   pure function inelastic_slip(group, e, p, slip, friction) result(mark)
      class(interface_group), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: slip        !! [m]
      real(wp), intent(in) :: friction    !! [Pa]
      real(wp) :: mark
      mark = slip - friction / (shear(group, e, p) - bond(group, e, p))
   end function inelastic_slip

   !> The force of a point that begins to slide with a friction, see `slider`; its balance is found with all the others'
   pure subroutine begin_sliding(group, e, p, friction, d, moved, lambda)
      class(interface_group), intent(inout) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: friction    !! [Pa]
      real(wp), intent(in) :: d(2)        !! jumps [m]
      real(wp), intent(in) :: moved(2)    !! per unit multiplier [m]
      real(wp), intent(in) :: lambda
      real(wp) :: spring
      spring = soft * shear(group, e, p)
      group%held(2, p) = -spring * moved(2)
      group%held(1, p) = friction - spring * d(2) - lambda * group%held(2, p)
   end subroutine begin_sliding

   !> One more vector of the change of a stiffness, softening where it is positive
   pure subroutine add_vector(group, e, p, v, change, event)
      class(interface_group), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: v(2)
      real(wp), intent(in) :: change       !! [Pa/m]
      type(event_vectors), intent(inout) :: event
      event%rank = event%rank + 1
      event%sign(event%rank) = sign(1.0_wp, change)
      call group%spread(e, sqrt(group%area(p) * abs(change)) * nodal(group, e, p, v), event, event%rank)
   end subroutine add_vector

   !> Bring a strength to the tooth at which no more of it is left than of the other. Where one is past its first, so
   !> is the other: the joint then opens and closes, and knows whether friction acts
   pure subroutine wear_with(teeth, table, tooth, its_table, its_tooth)
      type(tooth_tables), intent(in) :: teeth
      integer(c_int), intent(in) :: table, tooth        !! of the strength that fell
      integer(c_int), intent(in) :: its_table           !! of the one that follows
      integer(c_int), intent(inout) :: its_tooth
      if (tooth > 1) its_tooth = max(its_tooth, 2_c_int)
      do while (strength_left(teeth, its_table, its_tooth) > strength_left(teeth, table, tooth))
         its_tooth = its_tooth + 1_c_int
      end do
   end subroutine wear_with

   !> Part of a strength that is left, 1 before the first tooth has passed
   pure function strength_left(teeth, table, tooth) result(part)
      type(tooth_tables), intent(in) :: teeth
      integer(c_int), intent(in) :: table, tooth
      real(wp) :: part, strength
      part = 1.0_wp
      if (tooth == 1) return
      part = 0.0_wp
      if (table == 0) return
      strength = teeth%strength_of(table, tooth, 1.0_wp)
      if (strength < unbounded) part = strength / teeth%strength_of(table, 1_c_int, 1.0_wp)
   end function strength_left

   !> Rows: 1 stretch of the cohesion's slip [m], 2 and 7 held force, constant and per multiplier, over the power of two
   !> above the shear stiffness (no digit is lost) [m], 3 cracked, 4 tension tooth, 5 tooth of the cohesion,
   !> 6 compression tooth, 8 shut, 9 mark [m], 10 changes, 11 mode and 4 where the held force is even
   pure subroutine state(group, store, values)
      class(interface_group), intent(inout) :: group
      logical, intent(in) :: store
      real(wp), intent(inout) :: values(:, :)
      integer :: p
      if (store) then
         values(1, :) = group%start
         do p = 1, group%points
            values([2, 7], p) = scale(group%held(:, p), -exponent(group%law%ks((p + 1) / 2)))
         end do
         values(3, :) = merge(1.0_wp, 0.0_wp, group%tooth > 1)
         values(4, :) = real(group%tooth, wp)
         values(5, :) = real(group%slip, wp)
         values(6, :) = real(group%crush, wp)
         values(8, :) = real(group%shut, wp)
         values(9, :) = group%mark
         values(10, :) = real(group%changes, wp)
         values(11, :) = real(group%mode + 4_c_int * group%even, wp)
      else
         group%start(:) = values(1, :)
         do p = 1, group%points
            group%held(:, p) = scale(values([2, 7], p), exponent(group%law%ks((p + 1) / 2)))
         end do
         group%tooth(:) = nint(values(4, :), c_int)
         group%slip(:) = nint(values(5, :), c_int)
         group%crush(:) = nint(values(6, :), c_int)
         group%shut(:) = nint(values(8, :), c_int)
         group%mark(:) = values(9, :)
         group%changes(:) = nint(values(10, :), c_int)
         group%mode(:) = mod(nint(values(11, :), c_int), 4_c_int)
         group%stuck(:) = unbounded
         group%even(:) = min(nint(values(11, :), c_int) / 4_c_int, 1_c_int)
      end if
   end subroutine state

   !> Rows as of a plane point: jumps [m] for strains, 1 across, 3 along the joint and 2, between shells, out of their
   !> plane; 4 sigma, 6 tau, 5 that out of the plane; 7-8 the normal;
   !> 9 and 10 the stiffness left across and along; 11 tension tooth, 12 tooth of the cohesion; 15 area;
   !> 19 the band of its tooth tables [m]
   pure subroutine report(group, ua, ub, lambda, noise, values)
      class(interface_group), intent(in) :: group
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      real(wp), intent(out) :: values(:, :)     !! (report_rows, points)
      real(wp) :: la(most_entries), lb(most_entries), da(2), db(2), k, stays
      type(line) :: law
      type(scan_result) :: found
      integer :: e, p
      values = 0.0_wp
      do e = 1, group%elements
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         do p = 2 * e - 1, 2 * e
            k = across(group, e, p)
            law = along(group, e, p)
            da = jump(group, e, p, la)
            db = jump(group, e, p, lb)
            values(1:3:2, p) = da + lambda * db
            values(4, p) = k * values(1, p)
            if (allocated(group%row)) then
               values(2, p) = dot_product(group%row(:, 3, p), la(1:group%freedoms) + lambda * lb(1:group%freedoms))
               stays = 0.0_wp
               if (allocated(group%history)) stays = group%history(5, p)
               values(5, p) = group%law%ks(e) * (values(2, p) - stays)
            end if
            values(6, p) = law%k * values(3, p) - law%k0 + law%h(1) + lambda * law%h(2)
            values(7:8, p) = group%normal(:, e)
            values(9, p) = k / group%law%kn(e)
            values(10, p) = law%k / group%law%ks(e)
            if (group%mode(p) /= sticks) values(10, p) = bond(group, e, p) / group%law%ks(e)
            values(11, p) = real(group%tooth(p), wp)
            values(12, p) = real(group%slip(p), wp)
            found = scan_result()
            call scan_point(group, e, p, da, db, lambda, noise, found)
            values(13:14, p) = admitted(found)
            values(15, p) = group%area(p)
            values(16, p) = real(group%crush(p), wp)
            values(17, p) = 1.0_wp
            values(18, p) = real(group%shut(p), wp)
            values(19, p) = 1.0_wp
         end do
      end do
   end subroutine report

end module sla_interface
